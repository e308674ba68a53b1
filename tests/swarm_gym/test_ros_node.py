"""The node of docs/ros.md runs as it stands there, with minimal classes in place of those of ROS."""

import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
import shapely

from helpers.plans import obstacles_of
from helpers.public_maps import needed
from swarm_gym.planning import plan
from swarm_gym.scenarios import GridScenario
from swarm_gym.scenarios.formats.ros_map import read_ros_map

PAGE = (Path(__file__).parents[2] / "docs" / "ros.md").read_text()
SCRIPT = re.findall(r"`plan_server.py`.*?```python\n(.*?)```", PAGE, re.DOTALL)[0]


class Point:
    def __init__(self):
        self.x = self.y = self.z = 0.0


class Quaternion:
    def __init__(self):
        self.x = self.y = self.z = 0.0
        self.w = 1.0


class PoseStamped:
    def __init__(self, header=None):
        self.header = header
        self.pose = SimpleNamespace(position=Point(), orientation=Quaternion())


class GetPlan:
    class Request:
        def __init__(self, start, goal):
            self.start, self.goal = PoseStamped(), PoseStamped()
            for pose, (x, y) in ((self.start, start), (self.goal, goal)):
                pose.pose.position.x, pose.pose.position.y = x, y

    class Response:
        def __init__(self):
            self.plan = SimpleNamespace(header=SimpleNamespace(frame_id="", stamp=None), poses=[])


class OccupancyGrid:
    def __init__(self, values, resolution, corner):
        origin = SimpleNamespace(position=Point(), orientation=Quaternion())
        origin.position.x, origin.position.y = corner
        height, width = values.shape
        self.info = SimpleNamespace(resolution=resolution, width=width, height=height, origin=origin)
        self.data = values.ravel().tolist()


class Node:
    def __init__(self, name):
        self.name, self.topics, self.services, self.warnings = name, {}, {}, []

    def declare_parameter(self, _, value):
        return SimpleNamespace(value=value)

    def create_subscription(self, kind, topic, callback, qos, callback_group=None):
        assert kind is OccupancyGrid
        assert qos.durability == "transient local"
        assert callback_group is not None
        self.topics[topic] = callback

    def create_service(self, kind, name, callback, callback_group=None):
        assert kind is GetPlan
        assert callback_group is not None
        self.services[name] = callback

    def get_logger(self):
        return SimpleNamespace(warning=self.warnings.append)

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(to_msg=lambda: "now"))


class QoSProfile:
    def __init__(self, depth, durability):
        self.depth, self.durability = depth, durability


@pytest.fixture
def names(monkeypatch):
    """Return the names that the script defines."""
    replaced = {
        "rclpy": {},
        "rclpy.callback_groups": {"ReentrantCallbackGroup": object},
        "rclpy.executors": {"MultiThreadedExecutor": object},
        "rclpy.node": {"Node": Node},
        "rclpy.qos": {
            "QoSProfile": QoSProfile,
            "DurabilityPolicy": SimpleNamespace(TRANSIENT_LOCAL="transient local"),
        },
        "geometry_msgs": {},
        "geometry_msgs.msg": {"PoseStamped": PoseStamped},
        "nav_msgs": {},
        "nav_msgs.msg": {"OccupancyGrid": OccupancyGrid},
        "nav_msgs.srv": {"GetPlan": GetPlan},
    }
    for name, content in replaced.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    defined = {"__name__": "plan_server"}
    exec(SCRIPT, defined)
    defined["MAX_SECONDS"] = 60.0  # for slow machines
    monkeypatch.setattr(defined["gc"], "freeze", lambda: None)  # other tests collect garbage
    return defined


def asked(node, start, goal):
    return node.services["get_plan"](GetPlan.Request(start, goal), GetPlan.Response()).plan


def test_the_node_answers_on_the_data_of_a_map(names):
    pytest.importorskip("yaml", reason="needs the extra `maps`")
    grid = read_ros_map(needed("turtlebot3_world.yaml"))
    x, y, *_ = grid.extent
    message = OccupancyGrid(np.where(grid.blocked, 100, 0)[::-1].astype(np.int8), grid.resolution, (x, y))
    node = names["PlanServer"]()
    start, goal = (-2.0, -0.5), (2.0, 0.5)
    assert asked(node, start, goal).poses == []
    assert node.warnings == ["no map yet"]
    node.topics["map"](message)
    answer = asked(node, start, goal)
    assert (answer.header.frame_id, answer.header.stamp) == ("map", "now")
    points = np.array([(one.pose.position.x, one.pose.position.y) for one in answer.poses])
    expected = plan(GridScenario("map", grid, start, goal), robot_radius=0.2)
    np.testing.assert_allclose(points, expected.path, atol=1e-9)
    assert shapely.LineString(points).distance(obstacles_of(expected.map)) >= 0.2 - 1e-6
    turns = [one.pose.orientation for one in answer.poses]
    headings = [2.0 * np.arctan2(one.z, one.w) for one in turns]
    np.testing.assert_allclose(headings[:-1], np.arctan2(*np.diff(points, axis=0).T[::-1]), atol=1e-9)
    assert headings[-1] == headings[-2]


def test_the_node_keeps_its_corridor_and_answers_with_an_empty_plan_where_there_is_none(names):
    values = np.zeros((21, 31), dtype=np.int8)
    values[5:16, 15] = 100  # a wall with ways around both of its ends
    node = names["PlanServer"]()
    start, goal = (2.5, 10.4), (28.5, 10.4)

    def is_low(plan):
        return min(one.pose.position.y for one in plan.poses) < 6.0

    node.topics["map"](OccupancyGrid(values, 1.0, (0.0, 0.0)))
    assert is_low(asked(node, start, goal))
    values[4, 15] = 100  # the way above is a little shorter now
    node.topics["map"](OccupancyGrid(values, 1.0, (0.0, 0.0)))
    assert is_low(asked(node, start, goal))
    assert not is_low(asked(node, start, (28.5, 10.45)))  # another goal
    values[:, 15] = -1
    node.topics["map"](OccupancyGrid(values, 1.0, (0.0, 0.0)))
    assert asked(node, start, goal).poses == []
    assert "no path" in node.warnings[-1]
