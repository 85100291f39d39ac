"""How results of `rtphys identify` look: of one estimator, and of several side by side."""

from collections.abc import Sequence

from rtphys.cli.fitting import fitting_table, print_table
from rtphys.cli.terminal import say
from rtphys.identification.estimator import short_name
from rtphys.identification.result_file import Result
from rtphys.identification.scoring import Beyond, Score
from rtphys.physics import attributes

FEW = 6  # tasks that are shown one by one
GOOD = 0.8  # R2 from which an attribute counts as inferred


def show(result: Result) -> None:
    """Each task and attribute where tasks are few, else each attribute over all tasks."""
    if len(result.tasks) <= FEW:
        _one_by_one(result)
    else:
        _by_attribute(result)
    for task, found in result.tasks.items():
        for key, why in found.failed.items():
            say(f"{task}, {key}: the estimator failed: {why}", err=True)


def _one_by_one(result: Result) -> None:
    columns = ("R2", "95 %", "shuffled", "beyond", "n", "carried by")
    table = fitting_table(["task", "attribute"], columns)
    for task, found in result.tasks.items():
        for key, score in found.scores.items():
            cells = (_number(score.r2), _interval(score), _number(score.shuffled))
            beyond = "-" if score.beyond is None else _number(score.beyond.r2)
            table.add_row(task, key, *cells, beyond, str(score.n), carriers(score))
        table.add_section()
    print_table(table)
    for task, found in result.tasks.items():
        if found.left_out:
            reasons = ", ".join(f"{key} ({why})" for key, why in found.left_out.items())
            say(f"{task}: left out: {reasons}")


def _by_attribute(result: Result) -> None:
    columns = ("tasks", "mean R2", "best", f"R2 >= {GOOD}", "mean shuffled", "carried by")
    table = fitting_table(["attribute"], columns)
    for key in attributes():
        scores = {t: f.scores[key] for t, f in result.tasks.items() if key in f.scores}
        if not scores:
            continue
        best = max(scores, key=lambda task: scores[task].r2)
        inferred = sum(score.r2 >= GOOD for score in scores.values())
        mean = sum(score.r2 for score in scores.values()) / len(scores)
        shuffled = sum(score.shuffled for score in scores.values()) / len(scores)
        top = f"{best} {_number(scores[best].r2)}"
        cells = (str(len(scores)), _number(mean), top, str(inferred), _number(shuffled))
        table.add_row(key, *cells, carriers(scores[best]))
    print_table(table)


def carriers(score: Score) -> str:
    """The groups of signals without which R2 falls by 0.05 or more, the weightiest first."""
    weighty = sorted(score.importance.items(), key=lambda item: -item[1])
    return ", ".join(f"{group} {drop:.2f}" for group, drop in weighty if drop >= 0.05) or "-"


def compare_results(results: Sequence[Result]) -> None:
    """Mean R2 by attribute and estimator over the tasks that all of them have."""
    tasks = [t for t in results[0].tasks if all(t in result.tasks for result in results)]
    names = [short_name(result.estimator) for result in results]
    columns = [f"{name}{where}" for where in ("", ", beyond") for name in names]
    table = fitting_table(["attribute"], columns, title=_title(tasks), justify="right")
    for key in attributes():
        means = [r.mean(key, tasks, beyond) for beyond in (False, True) for r in results]
        if any(mean is not None for mean in means):
            table.add_row(key, *("-" if mean is None else _number(mean) for mean in means))
    print_table(table)
    for name, result in zip(names, results, strict=True):
        failed = sum(len(result.tasks[task].failed) for task in tasks)
        if failed:
            say(f"{name} failed on {failed} attributes of these tasks; they are left out")


def _title(tasks: Sequence[str]) -> str:
    return f"mean R2 over {len(tasks)} tasks that all have"


def _number(value: float) -> str:
    return f"{value:.2f}"


def _interval(score: Score | Beyond) -> str:
    return f"{score.interval[0]:.2f} .. {score.interval[1]:.2f}"
