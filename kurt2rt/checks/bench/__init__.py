"""The numbers: what the runtime takes, beside a reference measured in the same run, and the goal for it."""
