"""Write a sketch, a shader's sketch or a pasted text beside what is open."""
