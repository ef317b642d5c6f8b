// A node of ROS 1 that localizes a robot in a map: docs/ros1.md.
#include "io/cloud_file.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "localization/messages.h"
#include "localization/parameters.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <pcl_conversions/pcl_conversions.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <map>
#include <string>
#include <vector>

namespace {

using namespace bayesian_icp;
using app::Localization;

std::string
textOf(const std::string& name, XmlRpc::XmlRpcValue& value)
{
  switch (value.getType()) {
  case XmlRpc::XmlRpcValue::TypeBoolean:
    return bool(value) ? "true" : "false";
  case XmlRpc::XmlRpcValue::TypeInt:
    return io::textOf(int(value));
  case XmlRpc::XmlRpcValue::TypeDouble:
    return io::textOf(double(value));
  case XmlRpc::XmlRpcValue::TypeString:
    return value;
  case XmlRpc::XmlRpcValue::TypeArray: {
    std::string text;
    for (int i = 0; i < value.size(); ++i)
      text += (i == 0 ? "" : ",") + textOf(name, value[i]);
    return text;
  }
  default:
    throw io::UsageError("the parameter " + name +
                         " is neither a number, a text, true, false, nor a list");
  }
}

/** All parameters in the namespace of the node itself. */
std::map<std::string, std::string>
privateParameters(const ros::NodeHandle& node)
{
  std::vector<std::string> names;
  node.getParamNames(names);
  const std::string prefix = node.getNamespace() + "/";
  std::map<std::string, std::string> texts;
  for (const std::string& name : names) {
    XmlRpc::XmlRpcValue value;
    if (name.rfind(prefix, 0) == 0 && node.getParam(name, value))
      texts[name.substr(prefix.size())] = textOf(name, value);
  }
  return texts;
}

pcl::PCLPointCloud2::Ptr
cloudOf(const sensor_msgs::PointCloud2& message)
{
  auto cloud = pcl::make_shared<pcl::PCLPointCloud2>();
  pcl_conversions::toPCL(message, *cloud);
  return cloud;
}

/** Clouds have a callback queue of their own, which the main thread serves. Of the
 * clouds that arrive while one is localized, the last one stays in it. Maps and priors
 * come on another thread meanwhile. */
class Node {
public:
  Node()
  : private_node_("~")
  , options_(app::readParameters(privateParameters(private_node_)))
  , localizer_(options_)
  , posterior_(
        private_node_.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10))
  , measurement_(private_node_.advertise<geometry_msgs::PoseWithCovarianceStamped>(
        "measurement", 10))
  , draws_(private_node_.advertise<geometry_msgs::PoseArray>("draws", 10))
  , diagnostics_(node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10))
  {
    map_ = node_.subscribe("map", 1, &Node::takeMap, this);
    prior_ = node_.subscribe("prior", 100, &Node::takePrior, this);
    cloud_node_.setCallbackQueue(&clouds_);
    cloud_ = cloud_node_.subscribe("cloud", 1, &Node::takeCloud, this);
  }

  void
  run()
  {
    ros::AsyncSpinner maps_and_priors(1);
    maps_and_priors.start();
    while (ros::ok())
      clouds_.callAvailable(ros::WallDuration(0.1));
  }

private:
  void
  takeMap(const sensor_msgs::PointCloud2& message)
  {
    localizer_.setMap(cloudOf(message));
  }

  void
  takePrior(const geometry_msgs::PoseWithCovarianceStamped& message)
  {
    localizer_.addPrior(app::statedPoseOf(message));
  }

  void
  takeCloud(const sensor_msgs::PointCloud2& message)
  {
    const Localization localization =
        localizer_.localize(*cloudOf(message),
                            app::nanosecondsOf(message.header.stamp),
                            [](const Progress&) { return ros::ok(); });
    std_msgs::Header in_map = message.header;
    in_map.frame_id = options_.map_frame;
    if (localization.posterior) {
      geometry_msgs::PoseWithCovarianceStamped pose;
      app::fillStampedPose(in_map, *localization.posterior, pose);
      posterior_.publish(pose);
    }
    if (localization.measurement) {
      geometry_msgs::PoseWithCovarianceStamped pose;
      app::fillStampedPose(in_map, *localization.measurement, pose);
      measurement_.publish(pose);
    }
    if (localization.draws.rows() > 0) {
      geometry_msgs::PoseArray draws;
      app::fillPoseArray(in_map, localization.draws, draws);
      draws_.publish(draws);
    }
    publishDiagnostics(message.header, localization);
  }

  void
  publishDiagnostics(const std_msgs::Header& header, const Localization& localization)
  {
    diagnostic_msgs::DiagnosticArray diagnostics;
    app::fillDiagnostics(header,
                         ros::this_node::getName().substr(1) + ": localization",
                         localization,
                         diagnostics);
    diagnostics_.publish(diagnostics);
    if (localization.level == Localization::Level::Error)
      ROS_ERROR_STREAM_THROTTLE(5.0, "no pose: " << localization.message);
    if (localization.level == Localization::Level::Warning)
      ROS_WARN_STREAM_THROTTLE(5.0, localization.message);
  }

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  ros::CallbackQueue clouds_;
  ros::NodeHandle cloud_node_;
  app::LocalizerOptions options_;
  app::Localizer localizer_;
  ros::Publisher posterior_, measurement_, draws_, diagnostics_;
  ros::Subscriber map_, prior_, cloud_;
};

} // namespace

int
main(int argc, char** argv)
{
  ros::init(argc, argv, "localizer");
  io::silencePcl();
  const ros::NodeHandle one_more; // The last one takes ROS's log with it.
  try {
    Node().run();
  }
  catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 2;
  }
  return 0;
}
