"""Make a policy file from a stable-baselines3 zip: `python -m agents.import_sb3 --help`.

PPO of stable-baselines3 saved the zip: an `MlpPolicy` with tanh, on the observations and actions of this
project's environments. The command reads only its weights, as tensors, and the part of its `data` that is
plain JSON. It does not unpickle anything, so that no code of the zip runs. Layouts and sizes are in that JSON
where the model was trained in an environment of `swarm_gym.sb3.make_vec`; options override them. For a model
of another environment, the layouts have to be given.

Weights that PyTorch cannot read that way are refused. With `--trust-pickle` they are unpickled instead, which
runs any code in the zip with the rights of the user.
"""

import io
import json
import math
import pickle
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from swarm_gym.action import make_action
from swarm_gym.command import command
from swarm_gym.controllers import make_controller
from swarm_gym.controllers.controller import SizeLimits
from swarm_gym.controllers.learned.manifest import FEEDFORWARD, MAX_LAYERS, PolicyFileError
from swarm_gym.controllers.learned.policy_file import MAX_FILE, Weights, encode_policy
from swarm_gym.controllers.learned.residual import Base
from swarm_gym.controllers.names import ControllerName
from swarm_gym.controllers.packaged import read_bytes
from swarm_gym.controllers.registry import load_learned
from swarm_gym.files import write_atomically
from swarm_gym.observation import OBSERVATIONS, make_observation
from swarm_gym.optimizers import get_optimizer
from swarm_gym.outputs import require_outputs
from swarm_gym.runs.provenance import provenance
from swarm_gym.sb3 import SIGNATURE
from swarm_gym.settings import Settings

# Largest unpacked size of a zip in bytes: actor, critic, and the optimizer's two moments of both.
MAX_UNPACKED = 8 * MAX_FILE

# What a training has where neither options nor the zip say; layouts have to be known.
USUAL = {
    "observation": None, "action": None, "optimizer": "firefly", "base": "none",
    "initial_population_size": 80, "min_population_size": 2, "max_population_size": 200, "max_evaluations": 0,
}  # fmt: skip

_EXTRACTOR = re.compile(r"(?:pi_)?features_extractor\.")
_HIDDEN = re.compile(r"mlp_extractor\.policy_net\.([0-9]{1,4})\.weight")


@dataclass(frozen=True)
class ImportOptions:
    """Options of an import: the files, and the properties of the policy that are pickled in the zip."""

    zip: tyro.conf.Positional[Path]
    """Zip that stable-baselines3 saved, e.g. ppo.zip."""
    output: tyro.conf.Positional[Path]
    """Policy file to write, e.g. runs/mine.safetensors."""
    observation: str | None = None
    """Observation layout of the training, e.g. extended; layouts with a price cannot be imported. By default
    the one in the zip, as with all options below."""
    action: str | None = None
    """Action layout of the training, one that is scaled to [-1, 1], e.g. centred."""
    optimizer: str | None = None
    """Optimizer that the policy controls; firefly where the zip does not say."""
    base: str | None = None
    """Controller that the policy corrects, e.g. open-loop:three-cases; none where the zip does not say."""
    initial_population_size: int | None = None
    """Population size at the start of an episode, PS(0); 80 where the zip does not say."""
    min_population_size: int | None = None
    """Smallest population size that the policy can choose; 2 where the zip does not say."""
    max_population_size: int | None = None
    """Largest population size that the policy can choose; 200 where the zip does not say."""
    max_evaluations: int | None = None
    """Evaluation budget of an episode in the training; 0, the default where the zip does not say, is none."""
    observations_as_they_are: bool = False
    """State that `VecNormalize` around the environment had norm_obs=False; the zip has no statistics."""
    trust_pickle: bool = False
    """Unpickle weights that cannot be read as tensors alone. THIS RUNS CODE FROM THE ZIP."""


def import_sb3(options: ImportOptions) -> None:
    """Write the policy file.

    Raises:
        PolicyFileError: if the zip is unreadable, too large or of another network, or the options do not
            fit it.
        SettingError: if the output cannot be written, or is the zip.
    """
    path = options.zip
    require_outputs([options.output], [path])
    data, content = _members(path)
    _require_tanh(path, data)
    state = _read_state(path, content, options.trust_pickle)
    _require_plain(path, data, state, options.observations_as_they_are)
    weights = _actor(path, state)
    inputs = weights["0.weight"].shape[1]
    trained = _trained_on(options, data)
    _require_layouts(path, trained, inputs)
    try:
        features = _features(trained)
    except ValueError as error:
        raise PolicyFileError(f"{path}: {error}") from error
    _require_inputs(path, inputs, trained["observation"], len(features))
    manifest = {
        "action": trained["action"],
        "base": trained["base"],
        "config": {},
        "corrected_from": 0,
        "features": features,
        "hidden_layers": [len(weights[f"{number}.bias"]) for number in range(len(weights) // 2 - 1)],
        "imported_from": path.name,
        "initial_population_size": trained["initial_population_size"],
        "lstm_size": None,
        "max_evaluations": trained["max_evaluations"] or None,
        "max_population_size": trained["max_population_size"],
        "min_population_size": trained["min_population_size"],
        "network": FEEDFORWARD,
        "num_decisions": len(weights[f"{len(weights) // 2 - 1}.bias"]),
        "observation": trained["observation"],
        "optimizer": trained["optimizer"],
        "price": None,
        "provenance": provenance("numpy", "torch"),
    }
    if trained["first_source"] is not None:
        manifest["first_source"] = trained["first_source"]
    # Written beside the output until it has been loaded, so that a wrong option overwrites nothing.
    draft = write_atomically(
        options.output.with_name(f"{options.output.name}.draft"), encode_policy(weights, manifest)
    )
    try:
        load_learned(draft, SizeLimits(trained["min_population_size"], trained["max_population_size"]))
        draft.replace(options.output)
    except ValueError as error:
        raise PolicyFileError(f"{path}: does not fit these options: {error}") from error
    finally:
        draft.unlink(missing_ok=True)


def _features(trained: Mapping[str, Any]) -> list[str]:
    """Return the names of what the policy observes: those of its layout, then what a base proposes.

    Raises:
        UnknownNameError: if there is no such layout, optimizer or controller.
        ValueError: for a base that cannot be corrected in the action layout.
    """
    if trained["base"] == "none":
        return [feature.name for feature in make_observation(trained["observation"]).features]
    limits = SizeLimits(trained["min_population_size"], trained["max_population_size"])
    budget = trained["max_evaluations"] or None
    settings = Settings(
        action=trained["action"],
        max_evaluations=budget,
        initial_population_size=trained["initial_population_size"],
        min_population_size=limits.smallest,
        max_population_size=limits.largest,
    )
    layout = make_action(settings, get_optimizer(trained["optimizer"]))
    base = Base(make_controller(trained["base"], limits), layout, 0, budget)
    return base.features(trained["observation"])


def _trained_on(options: ImportOptions, data: Mapping[str, Any]) -> dict[str, Any]:
    """Return layouts and sizes of the training: those given, else those in the zip, else the usual ones."""
    space = data.get("action_space")
    stored = space.get(SIGNATURE) if isinstance(space, dict) else None
    trained = {**USUAL, **(stored if isinstance(stored, dict) else {})}
    given = {name: getattr(options, name) for name in USUAL}
    named = {name: trained[name] if value is None else value for name, value in given.items()}
    return {**named, "first_source": trained.get("first_source")}


def _require_layouts(path: Path, trained: Mapping[str, Any], inputs: int) -> None:
    """Raise an error if the layouts or sizes of the training are unknown, or are no names and numbers."""
    for name in ("observation", "action"):
        if trained[name] is None:
            fitting = f"; {_layouts_with(inputs)} has {inputs} inputs" if name == "observation" else ""
            raise PolicyFileError(
                f"{path}: the zip does not say with which {name} layout the model was trained, since its "
                f"environment was not made by swarm_gym.sb3.make_vec; name it with --{name}{fitting}"
            )
    for name, usual in USUAL.items():
        kind = int if isinstance(usual, int) else str
        if not isinstance(trained[name], kind) and (name, trained[name]) != ("max_evaluations", None):
            raise PolicyFileError(
                f"{path}: {name} must be of type {kind.__name__}, got {trained[name]!r:.80}"
            )


def _layouts_with(inputs: int) -> str:
    """Return the names of the observation layouts with so many features."""
    return " or ".join(n for n in OBSERVATIONS if len(OBSERVATIONS[n].features) == inputs) or "no layout"


def _require_inputs(path: Path, inputs: int, observation: str, features: int) -> None:
    """Raise an error if a network has another number of inputs than the observation has features."""
    if inputs == features:
        return
    raise PolicyFileError(
        f"{path}: the policy has {inputs} inputs, but observation {observation!r} has {features} features; "
        f"name the one of its training with --observation; {_layouts_with(inputs)} has {inputs}"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Import a policy with the options of the command line."""
    options = tyro.cli(ImportOptions, description=__doc__, args=arguments)
    with command():
        import_sb3(options)
    print(f"wrote {options.output}; use it as controller {ControllerName.of('learned', str(options.output))}")


def _members(path: Path) -> tuple[dict[str, Any], bytes]:
    """Return the plain JSON of a zip, and the file of its weights."""
    try:
        with _opened(read_bytes(path, MAX_FILE)) as archive:
            data, content = json.loads(archive.read("data")), archive.read("policy.pth")
        if zipfile.is_zipfile(io.BytesIO(content)):
            _opened(content).close()
    except (
        OSError,
        KeyError,
        ValueError,
        RecursionError,
        NotImplementedError,
        RuntimeError,
        zipfile.BadZipFile,
    ) as error:
        raise PolicyFileError(f"{path}: not a zip of stable-baselines3 ({error})") from error
    return data if isinstance(data, dict) else {}, content


def _read_state(path: Path, content: bytes, trust_pickle: bool) -> dict[str, Any]:
    """Return the tensors of the policy by name."""
    import torch

    try:
        state = torch.load(io.BytesIO(content), map_location="cpu", weights_only=not trust_pickle)
    except pickle.UnpicklingError as error:
        raise PolicyFileError(
            f"{path}: its weights hold more than tensors, and reading them may run code from the zip. If you "
            "trust its source, --trust-pickle reads them"
        ) from error
    except Exception as error:  # malformed bytes may raise anything
        raise PolicyFileError(f"{path}: unreadable weights ({type(error).__name__})") from error
    if not isinstance(state, dict):
        raise PolicyFileError(f"{path}: expected weights by name, got {type(state).__name__}")
    return state


def _opened(content: bytes) -> zipfile.ZipFile:
    """Open a zip; raise an error if it unpacks to more than `MAX_UNPACKED` bytes."""
    archive = zipfile.ZipFile(io.BytesIO(content))
    unpacked = sum(entry.file_size for entry in archive.infolist())
    if unpacked > MAX_UNPACKED:
        raise ValueError(f"expected to unpack at most {MAX_UNPACKED} bytes, got {unpacked}")
    return archive


def _require_tanh(path: Path, data: Mapping[str, Any]) -> None:
    """Raise an error for another activation function than tanh, by the plain JSON in `data`."""
    options = data.get("policy_kwargs")
    activation = options.get("activation_fn", "Tanh") if isinstance(options, dict) else None
    if not isinstance(activation, str) or not activation.rstrip("'>").endswith("Tanh"):
        raise PolicyFileError(f"{path}: expected a policy with activation_fn Tanh, got {activation!r:.80}")


def _require_plain(
    path: Path, data: Mapping[str, Any], state: Mapping[str, object], as_they_are: bool
) -> None:
    """Raise an error for what changes observations or actions besides the layers of the actor.

    Args:
        path: the zip, for messages.
        data: plain JSON of the zip.
        state: tensors of the zip by name.
        as_they_are: whether the user states that `VecNormalize` left observations as they are.
    """
    options = data.get("policy_kwargs")
    if isinstance(options, dict) and options.get("squash_output"):
        raise PolicyFileError(
            f"{path}: its actions are squashed (squash_output), which no policy file states"
        )
    extractor = next((name for name in state if _EXTRACTOR.match(str(name))), None)
    if extractor is not None:
        raise PolicyFileError(
            f"{path}: its features extractor has weights of its own ({extractor}), which no policy file holds"
        )
    if data.get("_last_original_obs") is not None and not as_they_are:
        raise PolicyFileError(
            f"{path}: it was trained within VecNormalize, whose statistics of observations the zip lacks; "
            "train with norm_obs=False. If that was so, say --observations-as-they-are"
        )


def _actor(path: Path, state: dict[str, Any]) -> Weights:
    """Return the layers of the actor under their names in policy files: numbers in order."""
    import torch

    places = sorted(int(match[1]) for name in state if (match := _HIDDEN.fullmatch(str(name))))
    layers = [*(f"mlp_extractor.policy_net.{place}" for place in places[:MAX_LAYERS]), "action_net"]
    weights = {}
    for number, layer in enumerate(layers):
        for part, dimensions in (("weight", 2), ("bias", 1)):
            tensor: Any = state.get(f"{layer}.{part}")
            plain = (
                isinstance(tensor, torch.Tensor) and tensor.dtype is torch.float32 and not tensor.is_sparse
            )
            # A view can have a larger shape than its storage.
            if not plain or tensor.ndim != dimensions or 4 * math.prod(tensor.shape) > MAX_FILE:
                raise PolicyFileError(
                    f"{path}: expected an MlpPolicy, with float32 numbers of {dimensions} dimensions as "
                    f"{layer}.{part}"
                )
            weights[f"{number}.{part}"] = tensor.detach().numpy().copy()
    return weights


if __name__ == "__main__":
    main()
