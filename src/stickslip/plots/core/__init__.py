"""What every plot uses: colours, figures, arguments, labels."""
