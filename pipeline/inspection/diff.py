"""What differs between two runs, and from where: named are the nodes at which the difference starts."""

from typing import Any

from kinetree.pipeline.planning.reason import Work, differences
from kinetree.pipeline.storage.store import Store


def difference(store: Store, a: dict[str, Any], b: dict[str, Any]) -> dict[str, Any]:
    """Nodes that only one run has, nodes whose artifacts differ, and among those the ones where it begins, with reasons.

    A difference begins at a node whose own parameters or code differ, or at an origin that found other content or is found in
    one of the runs alone (a frame that was added).
    """
    before, after = a["nodes"], b["nodes"]
    changed = [n for n in after if n in before and before[n].get("artifact") != after[n].get("artifact")]
    begins: dict[str, list[str]] = {}
    for label in [n for n in after if n in before and before[n].get("key") != after[n].get("key")] + changed:
        reasons = _begins(store, label, before[label], after[label])
        if reasons:
            begins[label] = reasons
    only_a, only_b = [n for n in before if n not in after], [n for n in after if n not in before]
    begins |= {n: ["input: removed"] for n in only_a if "values" in before[n]}
    begins |= {n: ["input: added"] for n in only_b if "values" in after[n]}
    return {
        "a": a["name"],
        "b": b["name"],
        "only_a": only_a,
        "only_b": only_b,
        "changed": changed,
        "begins": begins,
    }


def _begins(store: Store, label: str, before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    if "values" in before or "values" in after:
        return [f"input: {_content(before)} → {_content(after)}"]
    then, now = (store.record(node["key"]) if node.get("key") else None for node in (before, after))
    if then is None or now is None:
        return [f"{'not computed' if not after.get('key') else 'its record was removed'} in one of the runs"]
    reasons = differences(Work(now.params, now.code, now.inputs, now.index if now.asks_index else None), then)
    own = [str(reason) for reason in reasons if reason.kind in ("params", "code", "index")]
    return own or ([] if reasons else [f"{label} gave another result from the same inputs"] * (then.artifact != now.artifact))


def _content(node: dict[str, Any]) -> str:
    values = node.get("values") or {}
    return str(values.get("content") or values or "nothing")[:12]
