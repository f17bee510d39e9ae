"""Names of agents in results: whatever is replaced in the baseline is in its name."""

import pytest

import ramp


class Idle(ramp.Agent):
    """Does nothing."""

    name = "baseline"

    def work(self, robot):
        pass


class Press(ramp.Skill):
    """Gives up at once."""

    name = "press"

    def work(self, robot, task):
        return "not today"


def test_an_agent_has_no_name_of_the_benchmark():
    for name in ["baseline", "baseline+mine", "blind-tape"]:
        agent = Idle()
        agent.name = name
        with pytest.raises(ramp.InputError, match="the benchmark's own"):
            ramp.run("easy-1", agent=agent)


def test_a_skill_of_ones_own_is_named_with_the_hash_of_its_source(tmp_path):
    (tmp_path / "mine.toml").write_text("[agent]\nlatest = 0\n")
    options = {"world": "ideal", "track": "state", "parameters": tmp_path / "mine.toml"}
    result = ramp.run("easy-1", skills=[Press()], **options)
    skill, parameters = result.agent.split()[0].split("+")[1:]
    assert skill.startswith("fasten-by-press.") and len(skill) == len("fasten-by-press.") + 8
    assert parameters.startswith("parameters.")


def test_a_folder_of_plans_has_one_for_each_goal(tmp_path):
    ramp.plan("easy-1").save(tmp_path / "easy-1.json")
    with pytest.raises(ramp.InputError, match="no plan for the goal easy-2"):
        ramp.run("easy-2", plan=tmp_path)
