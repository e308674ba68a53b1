"""Write a policy's network as ONNX: `python -m agents.export_onnx POLICY OUTPUT`.

POLICY is the name of a packaged policy, or a file. The command needs the extra `onnx`. The graph is the
network alone, in float32, for any number of swarms N at once:

* Input `observation` (N, features): the policy's observations, scaled by its observation layout.
* Inputs `hidden` and `cell`, outputs `next_hidden` and `next_cell` (N, size): the state of an LSTM, if there
  is one; zeros at the start of an episode.
* Output `action` (N, decisions): clipped to [-1, 1], in the policy's action layout.

`swarm_gym.observation` scales observations and `swarm_gym.action` reads actions; neither is in the graph. If
a policy corrects another controller, that controller is not in the graph either: its proposals are the last
features, and `action` is the correction that is added to them. The metadata of the model has the manifest.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from swarm_gym.command import command
from swarm_gym.controllers.learned.manifest import CHOICES, LSTM
from swarm_gym.controllers.learned.policy_file import Weights, load_policy, resolve
from swarm_gym.errors import MissingExtraError
from swarm_gym.files import write_atomically
from swarm_gym.outputs import require_outputs

if TYPE_CHECKING:
    from onnx import ModelProto

# Supported by runtimes since 2022; the graph needs nothing newer.
OPSET = 17
IR_VERSION = 8

SEEN, ACTION = "observation", "action"
STATE = ("hidden", "cell")


def to_onnx(weights: Weights, manifest: Mapping[str, object]) -> "ModelProto":
    """Return the `onnx.ModelProto` of a policy's network.

    Raises:
        MissingExtraError: if the library onnx is missing.
    """
    try:
        from onnx import TensorProto, checker, helper, numpy_helper
    except ImportError as error:
        raise MissingExtraError("exporting a policy", "onnx", "onnx") from error

    import numpy as np

    stated: Any = manifest
    constants = {**weights, "low": np.float32(-1.0), "high": np.float32(1.0)}
    num_layers, memory = len(stated["hidden_layers"]) + 1, stated["network"] == LSTM
    nodes, entry = [], SEEN
    if memory:
        nodes, entry = _memory(helper), "next_hidden"
    for number in range(num_layers):
        affine = f"affine {number}"
        nodes.append(_affine(helper, entry, str(number), affine))
        if number < num_layers - 1:
            entry = f"layer {number}"
            nodes.append(helper.make_node("Tanh", [affine], [entry]))
    decided = affine
    if stated["network"] == CHOICES:
        decided = "decided"
        nodes.append(helper.make_node("ArgMax", [affine], ["best"], axis=1, keepdims=0))
        nodes.append(helper.make_node("Gather", ["choices", "best"], [decided], axis=0))
    nodes.append(helper.make_node("Clip", [decided, "low", "high"], [ACTION]))

    def described(names: Sequence[str], width: int) -> list[Any]:
        return [helper.make_tensor_value_info(name, TensorProto.FLOAT, ["N", width]) for name in names]

    size = stated["lstm_size"] or 0
    graph = helper.make_graph(
        nodes,
        "policy",
        described([SEEN], len(stated["features"])) + (described(STATE, size) if memory else []),
        described([ACTION], stated["num_decisions"])
        + (described([f"next_{name}" for name in STATE], size) if memory else []),
        [numpy_helper.from_array(np.asarray(array), name) for name, array in constants.items()],
    )
    imports = [helper.make_opsetid("", OPSET)]
    model = helper.make_model(graph, opset_imports=imports, ir_version=IR_VERSION, producer_name="swarm_gym")
    helper.set_model_props(model, {"manifest": json.dumps(manifest, sort_keys=True)})
    checker.check_model(model, full_check=True)
    return model


def main(arguments: Sequence[str] | None = None) -> None:
    """Export a policy with the options of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m agents.export_onnx", description="Write the network of a policy as an ONNX model."
    )
    parser.add_argument(
        "policy", metavar="POLICY", help="name of a packaged policy, e.g. three-cases/0, or a policy file"
    )
    parser.add_argument("output", metavar="OUTPUT", type=Path, help="file to write, e.g. policy.onnx")
    options = parser.parse_args(arguments)
    with command(MissingExtraError):
        policy = resolve(options.policy)
        require_outputs([options.output], [policy])
        model = to_onnx(*load_policy(policy))
        write_atomically(options.output, model.SerializeToString())
        print(f"wrote {options.output}")


def _affine(helper: Any, entry: str, layer: str, result: str) -> Any:
    return helper.make_node("Gemm", [entry, f"{layer}.weight", f"{layer}.bias"], [result], transB=1)


def _memory(helper: Any) -> list[Any]:
    """Return the nodes of one LSTM step, as in `learned.networks`; ONNX's LSTM takes a whole sequence."""
    gates = ("keep_new", "keep_old", "new", "show")  # i, f, g, o
    squash = {"keep_new": "Sigmoid", "keep_old": "Sigmoid", "new": "Tanh", "show": "Sigmoid"}
    return [
        helper.make_node("Concat", [SEEN, "hidden"], ["both"], axis=1),
        _affine(helper, "both", "lstm", "all gates"),
        helper.make_node("Split", ["all gates"], [f"raw {gate}" for gate in gates], axis=1),
        *(helper.make_node(squash[gate], [f"raw {gate}"], [gate]) for gate in gates),
        helper.make_node("Mul", ["keep_old", "cell"], ["kept"]),
        helper.make_node("Mul", ["keep_new", "new"], ["added"]),
        helper.make_node("Add", ["kept", "added"], ["next_cell"]),
        helper.make_node("Tanh", ["next_cell"], ["shown"]),
        helper.make_node("Mul", ["show", "shown"], ["next_hidden"]),
    ]


if __name__ == "__main__":
    main()
