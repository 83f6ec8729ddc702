"""Run a command and print its processor time and peak memory as JSON.

This is a process of its own because Linux counts the memory of the process that starts a program
as the program's own until it has loaded: the starter must be small. Call it with `python -I -S`.
"""

import json
import os
import signal
import sys


def main(seconds: int, command: list[str]) -> None:
    """Run the command for at most so many seconds, its output discarded but for errors."""
    child = os.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        try:
            os.execvp(command[0], command)
        except OSError:
            os._exit(127)
    signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGKILL))
    signal.alarm(seconds)
    _, status, usage = os.wait4(child, 0)
    signal.alarm(0)
    print(
        json.dumps(
            {
                "code": os.waitstatus_to_exitcode(status),
                "user": usage.ru_utime,
                "cpu": usage.ru_utime + usage.ru_stime,
                "memory": usage.ru_maxrss * 1024,
            }
        )
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
