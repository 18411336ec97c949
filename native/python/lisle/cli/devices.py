"""`lisle devices`: the graphics adapters."""

import argparse
import json

from .. import adapters
from ..errors import DeviceError

FIELDS = ("name", "backend", "device_type", "driver", "has_int64_atomics")


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Adds the command to a parser."""
    parser = commands.add_parser("devices", help="list the graphics adapters", description=__doc__)
    parser.add_argument("--json", action="store_true", help="machine-readable")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Prints the adapters, the default one first. None is a failure, in both forms: an empty list is printed, then."""
    found = adapters()
    if arguments.json:
        print(json.dumps([{field: getattr(adapter, field) for field in FIELDS} for adapter in found], indent=2))
    else:
        for adapter in found:
            atomics = "64-bit atomics" if adapter.has_int64_atomics else "32-bit atomics"
            print(f"{adapter.name}\n  {adapter.backend}, {adapter.device_type}, {adapter.driver}, {atomics}")
    if not found:
        raise DeviceError(
            "no graphics adapter answers: install a Vulkan driver (Debian: apt install mesa-vulkan-drivers)"
        )
