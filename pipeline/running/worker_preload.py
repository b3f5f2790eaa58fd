"""Imported by the process that workers are forked from, which then loads what every worker needs."""

import contextlib
import gc
import importlib
import os
import signal

SETUP = "KINETREE_WORKER_SETUP"
"""The variable of the environment that tells the process what the product has it load, as module:function."""
OURS = (
    "distributed.nanny",
    "distributed.worker",
    "kinetree.pipeline.running.own_cluster",
    "kinetree.pipeline.running.sent_parcels",
)


def load(setup: str) -> None:
    """Imports our own part and calls the product's; what fails, fails again in the worker that needs it, and is told there."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # what becomes of workers on Ctrl-C is for the run to say
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    os.environ.pop("PYTHONSAFEPATH", None)  # it is for this process alone
    gc.disable()  # nothing of what is imported is garbage
    for name in OURS:
        importlib.import_module(name)
    if setup:
        module, _, name = setup.partition(":")
        with contextlib.suppress(Exception):
            getattr(importlib.import_module(module), name)()
    gc.freeze()  # workers neither look at it again nor copy it
    gc.enable()


if SETUP in os.environ:
    load(os.environ.pop(SETUP))
