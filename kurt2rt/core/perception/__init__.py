"""From senses to the situation: ring buffer, features, and the definition that knowledge is bound to."""
