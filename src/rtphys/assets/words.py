"""Phrases for instructions from a few words a model."""


def phrases(noun: str, colour: str, feature: str, kind: str) -> tuple[str, ...]:
    """Six ways to name a thing, most telling first; no two are alike.

    Args:
        noun: what it is, "soda can".
        colour: how it looks, "red".
        feature: what it has, "a white label".
        kind: a plainer or other noun, "drink can".
    """
    return (
        f"{colour} {noun}",
        noun,
        f"{noun} with {feature}",
        f"{colour} {kind}",
        f"{kind} with {feature}",
        f"{colour} {noun} with {feature}",
    )
