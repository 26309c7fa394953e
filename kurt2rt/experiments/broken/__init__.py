"""Study of broken infra-red sensors: each sensor in turn, with each fault, against the policy with the same fault."""
