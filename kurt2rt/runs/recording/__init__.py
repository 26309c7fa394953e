"""What passed on the bus, kept in a file."""
