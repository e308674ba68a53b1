"""Readers of TensorBoard event files, without the times."""

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from tensorboard.plugins.hparams.plugin_data_pb2 import HParamsPluginData

EVERYTHING = {"images": 0, "scalars": 0, "tensors": 0, "histograms": 0}


def shown(folder, purge=True):
    """Return values with their steps by tag, in the order in which they were read.

    With `purge`, values that TensorBoard hides are left out.
    """
    events = EventAccumulator(str(folder), EVERYTHING, purge_orphaned_data=purge).Reload()
    tags = events.Tags()
    assert tags["tensors"] == tags["histograms"] == []
    pictures = {tag: events.Images(tag) for tag in tags["images"]}
    return {
        "scalars": {tag: [(e.step, e.value) for e in events.Scalars(tag)] for tag in tags["scalars"]},
        "images": {tag: [(e.step, e.encoded_image_string) for e in pictures[tag]] for tag in pictures},
        "hparams": {tag: _sorted(content) for tag, content in events.PluginTagToContent("hparams").items()},
    }


def _sorted(content):
    """Return a message with its maps sorted, since their order differs between processes."""
    return HParamsPluginData.FromString(content).SerializeToString(deterministic=True)
