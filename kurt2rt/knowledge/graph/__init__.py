"""RLA network as a graph and as a picture."""
