"""What the commands of all rooms share: arguments, options, standard input; and the commands of the core.

A command reads its arguments, calls what does the work, and prints. A room's own are in its ``commands``,
which ``playground.rooms`` lists. Needs the core; the command line needs it, so it stays.
"""
