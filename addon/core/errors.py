# SPDX-License-Identifier: GPL-3.0-or-later
"""What can go wrong between a scene and a picture. Every message names the object and what to do."""


class LisleError(Exception):
    """Base of the extension's own errors."""


class NativeError(LisleError):
    """The native module is missing or does not fit this Blender."""


class SceneError(LisleError):
    """The scene asks for something that cannot be drawn, a panoramic camera for example."""


class GeometryError(LisleError):
    """An object's curves cannot be read."""

    def __init__(self, object_name, reason):
        super().__init__(f"object '{object_name}': {reason}")
        self.object_name = object_name
        self.reason = reason


class RestShapeError(GeometryError):
    """An object's curves at a frame do not correspond to those at its reference frame."""

    def __init__(self, object_name, frame, reference_frame, reason):
        super().__init__(
            object_name,
            f"{reason} (frame {frame} against reference frame {reference_frame}). "
            "Choose another reference frame, or turn on 'Re-measure Each Frame' in Object › Yarn",
        )
        self.frame = frame
        self.reference_frame = reference_frame


class Cancelled(LisleError):
    """The user stopped the render."""


def message_of_bug(error):
    """What to tell the user about an exception that is none of the above; its trace goes to the console."""
    return f"{type(error).__name__}: {error} (this is a bug in Lisle, the console has its trace)"
