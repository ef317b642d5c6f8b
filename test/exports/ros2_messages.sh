# Writes definitions of messages as ROS 2 has them, and has its generator make C++ of them.
# Arguments: program rosidl, folder for everything, which is the include folder, too.
set -euo pipefail
rosidl=$1
folder=$2

# message <package> <name>: its fields are on standard input.
message() {
  mkdir -p "$folder/definitions/$1/msg"
  cat >"$folder/definitions/$1/msg/$2.msg"
}
message builtin_interfaces Time <<<'int32 sec
uint32 nanosec'
message std_msgs Header <<<'builtin_interfaces/Time stamp
string frame_id'
message geometry_msgs Point <<<'float64 x
float64 y
float64 z'
message geometry_msgs Quaternion <<<'float64 x 0
float64 y 0
float64 z 0
float64 w 1'
message geometry_msgs Pose <<<'Point position
Quaternion orientation'
message geometry_msgs PoseWithCovariance <<<'Pose pose
float64[36] covariance'
message geometry_msgs PoseWithCovarianceStamped <<<'std_msgs/Header header
PoseWithCovariance pose'
message geometry_msgs Vector3 <<<'float64 x
float64 y
float64 z'
message geometry_msgs Twist <<<'Vector3 linear
Vector3 angular'
message geometry_msgs TwistWithCovariance <<<'Twist twist
float64[36] covariance'
message nav_msgs Odometry <<<'std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist'

for definitions in "$folder"/definitions/*; do
  package=$(basename "$definitions")
  cd "$definitions"
  "$rosidl" generate -o "$folder/$package" -t cpp -I "$folder/definitions" "$package" msg/*.msg
done
