"""Study of doubt: how well its score tells wrong actions and collisions."""
