"""Pictures that move: frames, encoders and scenes of each mechanism."""
