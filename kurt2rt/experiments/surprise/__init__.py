"""How surprised a taught robot is: on ground that it knows, and where something is different."""
