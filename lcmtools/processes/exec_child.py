"""A program of its own that prepares a new process and becomes its command.

Its arguments: descriptors of the report and of the guard, the parent's process, the limit of file
sizes in bytes (0 for none), 1 to make standard input the controlling terminal, the variable
LC_CTYPE as "=value" or "", and the command. The number of the error goes into the report if the
command cannot be started. It imports nothing of lcmtools, so that it starts quickly.
"""

import contextlib
import os
import signal
import sys

_PR_SET_PDEATHSIG = 1


def main(words: list[str]) -> None:
    """Prepare this process and become the command."""
    report, guard, parent, most_bytes, has_terminal = map(int, words[:5])
    for descriptor in (report, guard):
        os.set_inheritable(descriptor, False)  # noqa: FBT003 - closed when the command begins
    if sys.platform == "linux":
        _end_with_parent()
    with contextlib.suppress(OSError):  # the reaper has been killed
        os.write(guard, b"+%d\n" % os.getpid())
    if os.getppid() != parent:  # it ended before the kernel could be told to send a signal
        os._exit(1)
    if has_terminal:
        _control_terminal()
    if most_bytes:
        import resource

        resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
    _restore(words[5])
    try:
        os.execvp(words[6], words[6:])  # noqa: S606 - the user's own
    except OSError as error:
        os.write(report, str(error.errno).encode())
        os._exit(127)


def _control_terminal() -> None:
    import fcntl
    import termios

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def _restore(lc_ctype: str) -> None:
    """Undo the changes that Python makes to its process."""
    if lc_ctype:  # Python sets it in the C locale (PEP 538)
        os.environ["LC_CTYPE"] = lc_ctype[1:]
    else:
        os.environ.pop("LC_CTYPE", None)
    for number in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them
        signal.signal(number, signal.SIG_DFL)


def _end_with_parent() -> None:
    """Have the kernel send SIGINT when the parent ends."""
    import ctypes

    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGINT), 0, 0, 0)


if __name__ == "__main__":
    main(sys.argv[1:])
