# SPDX-License-Identifier: GPL-3.0-or-later
"""A process of a batch that bakes stacks: run as a script, by Blender or by Python. It needs no add-on.

The arguments end with the folder of the package `lamina`. Each line of standard input is a request as JSON:
`stack`, `quality`, `basis`, `threads`, and `folder`, to which the table is written. The answer is a line of
standard output that begins with MARK: {"seconds": of the bake, or null if the table could not be written}, or
{"error": a sentence, "kind": the exception's name}. At the end of the input the process cancels its bake and
ends, so that no process stays behind when the batch is killed.
"""

import json
import queue
import signal
import sys
import threading

MARK = "lamina-worker: "


def main(package_folder):
    if package_folder not in sys.path:
        sys.path.insert(0, package_folder)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the batch, which then closes the input
    requests, ended = queue.SimpleQueue(), threading.Event()
    threading.Thread(target=_read, args=(requests, ended), daemon=True).start()
    while (request := requests.get()) is not None:
        print(MARK + json.dumps(_answer(request, ended)), flush=True)


def _read(requests, ended):
    for line in sys.stdin:
        requests.put(json.loads(line))
    ended.set()
    requests.put(None)


def _answer(request, ended):
    try:
        import lamina
        from lamina.baking.table.cache import LutCache

        stack = lamina.Stack.from_json(request["stack"])
        lut = lamina.bake(
            stack, request["quality"], cancel=ended.is_set, threads=request["threads"], basis=request["basis"]
        )
        try:
            LutCache(request["folder"]).save(lut)
        except OSError:
            return {"seconds": None}
        return {"seconds": lut.seconds}
    except Exception as error:
        return {"error": str(error), "kind": type(error).__name__}


if __name__ == "__main__":
    main(sys.argv[-1])
