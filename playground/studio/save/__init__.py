"""Write a sketch, a shader's sketch or a picture beside what is open."""
