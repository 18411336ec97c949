"""What can go wrong. The extension module raises these too."""


class Error(Exception):
    """Anything that Lisle refuses or fails to do."""


class InputError(Error, ValueError):
    """An argument or a file that cannot be drawn; the message names the object, the index and the reason."""


class DeviceError(Error):
    """No usable graphics adapter, or one that failed."""


class Cancelled(Error):
    """The progress callback returned False."""
