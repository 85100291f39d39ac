"""Descriptions of a model for language instructions, made from a few words."""

Words = tuple[str, str, str]  # noun, colour, feature, as `phrases` takes them


def phrases(noun: str, colour: str, feature: str, kind: str) -> tuple[str, ...]:
    """Six distinct noun phrases for one model, the most specific first.

    Args:
        noun: what it is, "soda can".
        colour: how it looks, "red".
        feature: what it has, "a white label".
        kind: a more general or another noun, "drink can".
    """
    return (
        f"{colour} {noun}",
        noun,
        f"{noun} with {feature}",
        f"{colour} {kind}",
        f"{kind} with {feature}",
        f"{colour} {noun} with {feature}",
    )
