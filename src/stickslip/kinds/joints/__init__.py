"""Records of several joints, whose laws are fitted together."""
