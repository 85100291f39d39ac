"""Fewer links: whatever is fixed to a fixed root link becomes part of that link."""

import sapien
from sapien.wrapper.articulation_builder import ArticulationBuilder


def fold_into_root(builder: ArticulationBuilder) -> None:
    """Move the shapes of all links that hang on the root by fixed joints into the root itself.

    PhysX spends as much on a link that cannot move as on one that can. Only for articulations
    whose root is fixed in the world: the root's mass is left as it was.
    """
    root, *others = builder.link_builders
    offsets = {root.index: sapien.Pose()}  # root <- link, of the links that cannot move
    kept = [root]
    for link in others:  # parents come before their children
        joint = link.joint_record
        X_RP = offsets.get(link.parent.index)
        if X_RP is not None and joint.joint_type == "fixed":
            X_RL = X_RP * joint.pose_in_parent * joint.pose_in_child.inv()
            offsets[link.index] = X_RL
            for record in (*link.collision_records, *link.visual_records):
                record.pose = X_RL * record.pose
            root.collision_records += link.collision_records
            root.visual_records += link.visual_records
            continue
        if X_RP is not None:
            joint.pose_in_parent, link.parent = X_RP * joint.pose_in_parent, root
        kept.append(link)
    for index, link in enumerate(kept):
        link.index = index
    builder.link_builders = kept
