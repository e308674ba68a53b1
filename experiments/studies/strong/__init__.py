"""The study of optimizers that are widely used, under control, beside the published table of MetaBox."""
