"""One list in the making: which seeds to hand out, and which results to wait for."""

import math
from collections import deque
from dataclasses import dataclass, field

from rtphys.data.episode import JSON
from rtphys.results.instances import Slot
from rtphys.setting.recipe import Recipe
from rtphys.studies.certify.ledger import Ledger
from rtphys.studies.certify.plan import CertifyPlan, measurable
from rtphys.studies.certify.work import Job

BARREN = 200  # infeasible seeds in a row after which a list is given up
LOOKAHEAD = 4  # results a worker may be ahead of the slowest


@dataclass
class Order:
    """First known rows gain the baselines they lack, then new seeds are tried.

    New slots are committed in the order of their seeds. A seed without a verdict stops its list
    for this run: whatever is behind it must wait, or the list would depend on a machine's mishaps.
    """

    plan: CertifyPlan
    task: str
    protocol: str
    ground: dict[str, JSON]
    under_way: set[int] = field(default_factory=set)
    waiting: dict[int, Slot] = field(default_factory=dict)  # for an earlier seed's result
    troubles: dict[int, str] = field(default_factory=dict)  # seeds without a verdict, and why
    stopped: str = ""  # why it stays short

    def __post_init__(self) -> None:
        plan = self.plan
        self._ledger = Ledger(
            plan.out, self.task, self.protocol, self.ground, plan.first_seed, plan.baselines
        )
        self.path = self._ledger.path
        self._baselines = measurable(self._ledger.baselines, self.protocol)
        owed = self._ledger.lacking()
        self._lacking = {
            seed: names for seed in owed if (names := measurable(owed[seed], self.protocol))
        }
        self._again = deque(self._lacking)
        self._next = self._ledger.expected
        self._judge()
        if not self.over:
            self._ledger.promise()

    # ---- what the supervisor asks ----------------------------------------------------------------

    @property
    def slots(self) -> list[Slot]:
        return self._ledger.slots

    @property
    def feasible(self) -> int:
        return sum(slot.feasible for slot in self.slots)

    @property
    def lacking(self) -> int:
        """Feasible seeds that lack a baseline."""
        return len(self._lacking)

    @property
    def complete(self) -> bool:
        return self.feasible >= self.plan.feasible

    @property
    def whole(self) -> bool:
        """Nothing can be added to it under this plan."""
        return (self.complete or bool(self.stopped)) and not self._lacking

    @property
    def over(self) -> bool:
        return self.whole or bool(self.troubles and not self.under_way)

    @property
    def halted(self) -> str:
        """Why it is left for another run; empty if it is whole or goes on."""
        if self.whole or not self.over:
            return ""
        told = "; ".join(f"seed {seed}: {self.troubles[seed]}" for seed in sorted(self.troubles))
        return f"{told}. {self.path} is not written yet; what is finished is kept beside it"

    @property
    def wants(self) -> bool:
        """Whether one more attempt should begin: as many as the missing seeds are worth."""
        if self.over or self.troubles:
            return False
        if self._again:
            return True
        ahead = self._next - self._ledger.expected
        if self.complete or self.stopped or ahead >= LOOKAHEAD * self.plan.workers:
            return False
        if self._next >= self.plan.first_seed + self.plan.most_attempts:
            return False
        ready = sum(slot.feasible for slot in self.waiting.values())
        rate = (self.feasible + 1) / (len(self.slots) + 1)
        new = len(self.under_way - self._lacking.keys())
        return new < math.ceil((self.plan.feasible - self.feasible - ready) / rate)

    def begin(self) -> Job:
        if self._again:
            seed = self._again.popleft()
            baselines = self._lacking[seed]
        else:
            seed, self._next = self._next, self._next + 1
            baselines = self._baselines
        self.under_way.add(seed)
        return Job(Recipe(self.task, seed, self.protocol), baselines)

    def take(self, slot: Slot) -> None:
        """Commits it and those that waited for it; those past the last one needed are dropped."""
        self.under_way.discard(slot.seed)
        if slot.seed in self._lacking:
            self._complement(slot)
            return
        self.waiting[slot.seed] = slot
        while not (self.complete or self.stopped) and self._ledger.expected in self.waiting:
            self._ledger.commit(self.waiting.pop(self._ledger.expected))
            self._judge()
        if self.complete or self.stopped:
            self.waiting.clear()

    def lose(self, seed: int, reason: str, detail: str) -> None:
        """Its workers were lost, which says nothing about the seed."""
        self.under_way.discard(seed)
        self.troubles[seed] = (
            f"{reason}: the last worker that tried it {detail}, which is no verdict on the seed; "
            "the same command tries it again"
        )

    def close(self) -> None:
        """Writes the list once it is whole. Raises `CannotWrite`."""
        if self.whole:
            self._ledger.write()

    # ----------------------------------------------------------------------------------------------

    def _complement(self, slot: Slot) -> None:
        known = self._ledger.slot(slot.seed)
        if slot.state != known.state:
            now = slot.reason or f"state {slot.state}"
            self.troubles[slot.seed] = (
                f"came out otherwise than in the list: {now}, not state {known.state}; a list made "
                "on another kind of machine cannot be added to here"
            )
            return
        self._ledger.commit(slot)
        del self._lacking[slot.seed]

    def _judge(self) -> None:
        if self.complete:
            return
        last = [slot.feasible for slot in self.slots[-BARREN:]]
        if len(last) == BARREN and not any(last):
            self.stopped = f"none of the last {BARREN} seeds is feasible"
        elif len(self.slots) >= self.plan.most_attempts:
            self.stopped = f"{len(self.slots)} seeds were tried, the most that were allowed"
