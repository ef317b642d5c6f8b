# Runs the installed tools where nothing but their own path leads to the libraries.
# Arguments: prefix.
set -euo pipefail
prefix=$1
tools=(pcl_bayesian_icp pcl_bayesian_icp_batch pcl_bayesian_icp_evaluate
  pcl_bayesian_icp_pose_graph pcl_bayesian_icp_simulate pcl_bayesian_icp_track
  pcl_bayesian_icp_transform)
# Built only where VTK is.
[[ ! -e $prefix/bin/pcl_bayesian_icp_viewer ]] || tools+=(pcl_bayesian_icp_viewer)
for tool in "${tools[@]}"; do
  env -i "$prefix/bin/$tool" --help >/dev/null
  libraries=$(env -i "$(command -v ldd)" "$prefix/bin/$tool" | grep libpcl_bayesian_icp || true)
  echo "$tool: $libraries"
  # The studies have the objects of the libraries in them.
  [[ $tool == *_evaluate || $libraries ]]
  # The tool's own rpath, not the build folder's.
  if [[ $libraries ]] && grep -v -F "$prefix/" <<<"$libraries"; then
    exit 1
  fi
done
# The report is made by files that were installed with the tool; of an empty folder they
# say so.
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
said=$("$prefix/bin/pcl_bayesian_icp_evaluate" report "$folder" 2>&1) || true
echo "$said"
grep -F "has no rows of a study" <<<"$said" >/dev/null
