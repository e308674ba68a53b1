"""Control of the sum of length and nearness to obstacles on generated grid maps."""
