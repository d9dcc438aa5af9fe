"""Errors meant for people: one message that names what is wrong and the remedy."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import NoReturn


class FayingError(Exception):
    """Base of all errors faying raises on purpose; the command line shows no traceback."""


class ModelError(FayingError):
    """The model cannot be used as described: an unconstrained body, a set that is not there."""


class FormatError(FayingError):
    """A file cannot be read: it is missing, malformed, or asks for something unsupported."""


class StudyError(FayingError):
    """A study file asks for something that does not exist or does not fit together."""


class ConvergenceError(FayingError):
    """An iteration ended without a solution; the message says how far it got and what to try."""


class CampaignError(FayingError):
    """Tasks could not be computed: workers that died or cannot be had, errors of a user's code."""


def refuse(text: str) -> NoReturn:
    """Raise the error that a file cannot be read."""
    raise FormatError(text)


def refuse_model(text: str) -> NoReturn:
    """Raise the error that a model cannot be used as described."""
    raise ModelError(text)


def refuse_study(text: str) -> NoReturn:
    """Raise the error that a study does not fit together."""
    raise StudyError(text)


def refuse_value(text: str) -> NoReturn:
    """Raise the error that a value cannot be, where what is read says to whom it belongs."""
    raise ValueError(text)


def check_known(name: object, known: Iterable[object], what: str) -> None:
    """Refuse a name that is none of those of its kind, as ``"bolt"``."""
    names = list(known)
    if name not in names:
        several = f"{what[:-1]}ies" if what.endswith("y") else f"{what}s"
        listed = ", ".join(map(str, names)) or "none"
        refuse_model(f"there is no {what} '{name}'; the {several} are {listed}")


@contextmanager
def naming(subject: str) -> Iterator[None]:
    """Put what a model or convergence error raised inside speaks of in front of its message."""
    try:
        yield
    except ModelError as error:
        message = f"{subject}: {error}"
        # Kinds that hold more than a message stay below it.
        plain = type(error).__init__ is ModelError.__init__
        raise (type(error) if plain else ModelError)(message) from None
    except ConvergenceError as error:
        message = f"{subject}: {error}"
        raise ConvergenceError(message) from None
