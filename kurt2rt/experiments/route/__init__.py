"""Fixed routes: taught to the mid level of robots that know the streets already, then driven without a teacher."""
