"""Grade what a class has handed in: each submission in a worker process, a table and a contact sheet."""
