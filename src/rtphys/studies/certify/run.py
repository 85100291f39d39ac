"""`certify`: finds the seeds on which policies are evaluated, those that the expert solves."""

from dataclasses import replace

from rtphys.assets.pack import Pack
from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.data.files import make_folder
from rtphys.data.lock import FolderLock
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.episode.generate import attempt
from rtphys.episode.replay import actions_of, replay
from rtphys.results.instances import HASH_LENGTH, Slot
from rtphys.setting.setting import Recipe, Setting
from rtphys.studies.certify.certified_list import CertifiedList, Job
from rtphys.studies.certify.plan import CertifyPlan
from rtphys.studies.worker import StudyWorker
from rtphys.task.spec import Task, load_task


def certify(plan: CertifyPlan, pack: Pack, listener: Listener | None = None) -> list[CertifiedList]:
    """Certifies until every list has its feasible seeds, is given up, or meets a lost worker.

    The lists depend on the plan alone, not on the number of workers, nor on how often the run was
    killed and resumed. A seed that takes its workers with it gets no verdict: its list is left as
    it is, `series.halted` says why, and the same call goes on there.

    Raises:
        RtphysError: a list with another fingerprint; another
            run at work in the folder; an error in a worker.
    """
    tasks, listener = [load_task(name) for name in plan.tasks], listener or Listener()
    make_folder(plan.out)
    with FolderLock(plan.out):
        lists = [_open(plan, task, name, pack) for name in plan.protocols for task in tasks]
        size = cores() if plan.workers is None else plan.workers
        with LocalPool[Job, Slot](CertifyWorker(pack), size, plan.limits, listener.noticed) as pool:
            run_all([certified.series for certified in lists], pool, listener, plan.out)
    return lists


def _open(plan: CertifyPlan, task: Task, protocol: str, pack: Pack) -> CertifiedList:
    fingerprint = fingerprint_of(task, protocol, pack).to_json()
    return CertifiedList(plan, Setting(task.name, protocol), fingerprint)


class CertifyWorker(StudyWorker[Job, Slot]):
    """Lets the expert try a seed, without pictures, and measures baselines on a feasible one."""

    def do(self, job: Job) -> Slot:
        recipe = job.recipe
        tried = attempt(recipe, self.tasks[recipe.task], self.pack)
        if not tried.accepted or tried.recording is None:
            return Slot(recipe.seed, tried.reason)
        state, alone, twin = tried.recording.hash[:HASH_LENGTH], None, None
        if "replay" in job.baselines:
            alone = replay(recipe, self.tasks[recipe.task], self.pack, actions_of(tried.recording))
        if "twin" in job.baselines:
            twin = self._twin(recipe)
        return Slot(recipe.seed, "", state, alone, twin)

    def _twin(self, recipe: Recipe) -> bool | None:
        """Whether clean actions do under this physics; None if the clean expert fails."""
        task = self.tasks[recipe.task]
        clean = attempt(
            Recipe(replace(recipe.setting, protocol="clean"), recipe.seed), task, self.pack
        )
        if not clean.accepted or clean.recording is None:
            return None
        return replay(recipe, task, self.pack, actions_of(clean.recording))
