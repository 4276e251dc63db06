"""Grade what a class has handed in: submissions are read, judged in worker processes, and reported."""
