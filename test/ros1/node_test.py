"""Runs the node of ROS 1 with a real roscore: maps, priors and clouds in, poses and
diagnostics out."""

import os
import pathlib
import queue
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "cli"))
import cloud_files

PROGRAMS = pathlib.Path(os.environ["PCL_BAYESIAN_ICP_PROGRAMS"])
STAMP = 1700000000


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


# rospy reads its environment when it is imported.
HOME = tempfile.TemporaryDirectory()
PORT = free_port()
os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{PORT}"
os.environ["ROS_IP"] = "127.0.0.1"
os.environ["ROS_HOME"] = HOME.name

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
from sensor_msgs.msg import PointCloud2, PointField


def stamped(message, frame, seconds=0.0):
    message.header.stamp = rospy.Time.from_sec(STAMP + seconds)
    message.header.frame_id = frame
    return message


def cloud_message(points, frame, seconds=0.0):
    """Of x, y, z of all points as 32-bit floats [m]."""
    message = stamped(PointCloud2(), frame, seconds)
    message.fields = [
        PointField(name, 4 * k, PointField.FLOAT32, 1) for k, name in enumerate("xyz")
    ]
    message.height, message.width = 1, len(points) // 12
    message.point_step, message.row_step = 12, len(points)
    message.data = points
    return message


def prior_message(pose, deviation, frame="map", seconds=0.0):
    """About x, y, z, roll, pitch, yaw [m, rad], roll and pitch being 0."""
    message = stamped(PoseWithCovarianceStamped(), frame, seconds)
    position, orientation = message.pose.pose.position, message.pose.pose.orientation
    position.x, position.y, position.z = pose[:3]
    orientation.z, orientation.w = np.sin(pose[5] / 2), np.cos(pose[5] / 2)
    message.pose.covariance = (deviation**2 * np.eye(6)).ravel().tolist()
    return message


def errors_of(pose, true_pose):
    """Of a geometry_msgs/Pose as ROS's covariances describe them: dx, dy, dz, and the
    rotation vector about the fixed axes; to first order, of a true pose that is level."""
    x, y, z, w = (getattr(pose.orientation, name) for name in "xyzw")
    c, s = np.cos(true_pose[5] / 2), -np.sin(true_pose[5] / 2)
    # Vector part of (x, y, z, w) times the true orientation's inverse (0, 0, s, c).
    vector = np.array([c * x + s * y, c * y - s * x, c * z + s * w])
    position = [pose.position.x, pose.position.y, pose.position.z]
    return np.concatenate([np.subtract(position, true_pose[:3]), 2 * vector])


def wait_for(what, condition):
    deadline = time.monotonic() + 60
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(f"{what} is not there after a minute")
        time.sleep(0.1)


def is_master_there():
    try:
        rospy.get_master().getPid()
    except OSError:
        return False
    return True


def end(process):
    """Ctrl-C for a process and its children, if it still runs."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(30)


class Inbox:
    """What arrives on a topic."""

    def __init__(self, topic, kind):
        self.messages = queue.Queue()
        self.subscriber = rospy.Subscriber(topic, kind, self.messages.put)

    def next(self):
        return self.messages.get(timeout=60)


class NodeTest(unittest.TestCase):
    """One roscore and two scans of a room for all tests, a node for each."""

    @classmethod
    def setUpClass(cls):
        core = subprocess.Popen(["roscore", "-p", str(PORT)], start_new_session=True)
        cls.addClassCleanup(end, core)
        wait_for("roscore", is_master_there)
        rospy.init_node("robot", disable_signals=True)
        scans = pathlib.Path(HOME.name) / "room"
        simulator = PROGRAMS / "pcl_bayesian_icp_simulate"
        command = [simulator, "--scene", "room", "-o", scans]
        subprocess.run(command, check=True, stdout=subprocess.PIPE)
        cls.map_points, cls.points = (
            cloud_files.read_xyz(scans / name).astype("<f4").tobytes()
            for name in ("target.pcd", "source.pcd")
        )
        # The robot has turned by 0.1 rad.
        cls.true_pose = (*np.loadtxt(scans / "T_target_source.txt")[:3, 3], 0, 0, 0.1)

    def start_node(self, *parameters):
        command = [PROGRAMS / "pcl_bayesian_icp_ros1_node", *parameters]
        node = subprocess.Popen(
            command, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        self.addCleanup(self.forget_parameters)
        self.addCleanup(node.stdout.close)
        self.addCleanup(end, node)
        return node

    @staticmethod
    def forget_parameters():
        """roscore keeps those of a node that has ended."""
        if rospy.has_param("localizer"):
            rospy.delete_param("localizer")

    def setUp(self):
        self.publishers = {
            topic: rospy.Publisher(topic, kind, queue_size=10)
            for topic, kind in (
                ("map", PointCloud2),
                ("prior", PoseWithCovarianceStamped),
                ("cloud", PointCloud2),
            )
        }
        self.poses = Inbox("localizer/pose", PoseWithCovarianceStamped)
        self.measurements = Inbox("localizer/measurement", PoseWithCovarianceStamped)
        self.draws = Inbox("localizer/draws", PoseArray)
        self.diagnostics = Inbox("/diagnostics", DiagnosticArray)
        inboxes = (self.poses, self.measurements, self.draws, self.diagnostics)
        self.subscribers = [inbox.subscriber for inbox in inboxes]
        for end_of_topic in (*self.publishers.values(), *self.subscribers):
            self.addCleanup(end_of_topic.unregister)

    def connect(self):
        """Wait for the node to have all its topics."""
        ends = (*self.publishers.values(), *self.subscribers)
        wait_for("the node", lambda: all(one.get_num_connections() > 0 for one in ends))

    def send(self, topic, message):
        self.publishers[topic].publish(message)

    def give_map_and_prior(self):
        self.send("map", cloud_message(self.map_points, "map"))
        self.send("prior", prior_message(np.add(self.true_pose, 0.02), 0.05))
        time.sleep(1)  # messages of different topics may overtake each other

    def status_of(self, cloud):
        """What the diagnostics say of a cloud."""
        self.send("cloud", cloud)
        array = self.diagnostics.next()
        self.assertEqual(array.header.stamp, cloud.header.stamp)
        (status,) = array.status
        self.assertEqual(status.name, "localizer: localization")
        return status

    def assert_no_pose(self, words, cloud):
        status = self.status_of(cloud)
        self.assertEqual(status.level, DiagnosticStatus.ERROR)
        self.assertIn(words, status.message)
        # Published before the diagnostics, if at all.
        time.sleep(0.2)
        self.assertTrue(self.poses.messages.empty() and self.draws.messages.empty())

    def test_finds_the_pose(self):
        self.start_node("_seed:=7", "_threads:=2", "_samples:=3000")
        self.connect()
        self.give_map_and_prior()
        cloud = cloud_message(self.points, "base_link", 0.25)
        status = self.status_of(cloud)
        self.assertIn(status.level, (DiagnosticStatus.OK, DiagnosticStatus.WARN), status)
        values = {pair.key: pair.value for pair in status.values}
        self.assertEqual(values["prior's age [s]"], "0.25")
        pose, measurement = self.poses.next(), self.measurements.next()
        draws = self.draws.next()
        for message in (pose, measurement, draws):
            self.assertEqual(message.header.frame_id, "map")
            self.assertEqual(message.header.stamp, cloud.header.stamp)
        for message in (pose, measurement):
            error = errors_of(message.pose.pose, self.true_pose)
            covariance = np.reshape(message.pose.covariance, (6, 6))
            self.assertLess(error @ np.linalg.solve(covariance, error), 30)
            self.assertLess(np.abs(error).max(), 0.01)
        self.assertEqual(len(draws.poses), 3000)
        # The covariance is that of the draws, in ROS's order and units.
        errors = np.array([errors_of(draw, self.true_pose) for draw in draws.poses])
        covariance = np.reshape(pose.pose.covariance, (6, 6))
        smallest = 1e-3 * np.diag(covariance).max()
        np.testing.assert_allclose(np.cov(errors.T), covariance, rtol=0.02, atol=smallest)

    def test_says_why_there_is_no_pose(self):
        self.start_node("_max_prior_age_s:=0.5")
        self.connect()
        cloud = cloud_message(self.points, "base_link")
        self.assert_no_pose("no map has arrived", cloud)
        self.send("map", cloud_message(self.map_points, "odom"))
        time.sleep(1)
        self.assert_no_pose("the map's frame_id is 'odom', but must be 'map'", cloud)
        self.send("map", cloud_message(self.map_points, "map"))
        time.sleep(1)
        self.assert_no_pose("no prior has arrived", cloud)
        for words, prior in (
            ("the nearest is 3 s older", prior_message(self.true_pose, 0.05, seconds=-3)),
            ("the prior's frame_id is 'odom'", prior_message(self.true_pose, 0.05, "odom")),
            ("variance of x is 0", prior_message(self.true_pose, 0.0)),
        ):
            self.send("prior", prior)
            time.sleep(0.5)
            self.assert_no_pose(words, cloud)
        self.send("prior", prior_message(self.true_pose, 0.05))
        time.sleep(0.5)
        elsewhere = cloud_message(self.points, "lidar")
        self.assert_no_pose("the cloud's frame_id is 'lidar'", elsewhere)
        self.assert_no_pose("no points", cloud_message(b"", "base_link"))
        self.assert_no_pose("no finite points", cloud_message(b"\xff" * 12000, "base_link"))
        self.assertNotEqual(self.status_of(cloud).level, DiagnosticStatus.ERROR)
        self.poses.next()

    def test_takes_the_last_cloud_when_it_is_busy(self):
        self.start_node()
        self.connect()
        self.give_map_and_prior()
        for k in range(8):
            self.send("cloud", cloud_message(self.points, "base_link", k / 100))
        stamps = [self.poses.next().header.stamp.to_sec() - STAMP]
        while not np.isclose(stamps[-1], 0.07):
            stamps.append(self.poses.next().header.stamp.to_sec() - STAMP)
        self.assertLess(len(stamps), 8)
        self.assertEqual(stamps, sorted(stamps))

    def test_ends_while_it_samples(self):
        node = self.start_node("_samples:=2000000")
        self.connect()
        self.give_map_and_prior()
        self.send("cloud", cloud_message(self.points, "base_link"))
        time.sleep(2)
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(20), 0)

    def test_refuses_parameters_that_it_does_not_know(self):
        for parameter, words in (
            ("_sead:=1", b"no parameter 'sead'"),
            ("_preset:=best", b"preset"),
            ("_seed:=-1", b"seed"),
        ):
            node = self.start_node(parameter)
            output = node.communicate(timeout=30)[0]
            self.assertEqual(node.returncode, 2, output)
            self.assertIn(words, output)
            self.forget_parameters()


if __name__ == "__main__":
    unittest.main(warnings="ignore")  # of sockets that rospy leaves open
