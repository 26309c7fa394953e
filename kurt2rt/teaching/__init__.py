"""The teacher's side: commands, questions, lessons, and a scripted teacher."""
