// Relative names of all topics, services and actions; launch files may remap them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {
namespace topics {

constexpr char kImage[] = "camera/image_raw";  ///< sensor_msgs/Image
/// sensor_msgs/CameraInfo, latched; only for cameras with a pinhole model
constexpr char kImageInfo[] = "camera/camera_info";
/// sensor_msgs/Image for people: large, rendered while a node subscribes
constexpr char kView[] = "camera_view/image_raw";
constexpr char kViewInfo[] = "camera_view/camera_info";  ///< sensor_msgs/CameraInfo, latched
constexpr char kGoalImage[] = "goal_image";              ///< sensor_msgs/Image, latched
constexpr char kTorque[] = "torque";                     ///< ddm_msgs/Torque
/// ddm_msgs/Torque: the torque that acted after each image; empty if none did
constexpr char kAppliedTorque[] = "applied_torque";
constexpr char kEffortCommand[] = "effort_command";  ///< std_msgs/Float64 [N m], for one motor
constexpr char kGroupEffortCommand[] =
    "group_effort_command";  ///< std_msgs/Float64MultiArray [N m], for several motors
constexpr char kGroundTruth[] =
    "ground_truth/joint_states";                 ///< sensor_msgs/JointState, for evaluation only
constexpr char kModel[] = "model";               ///< ddm_msgs/Model, latched
constexpr char kPlan[] = "plan";                 ///< ddm_msgs/Plan
constexpr char kPlanScalars[] = "plan_scalars";  ///< ddm_msgs/PlanScalars
constexpr char kPredictionImage[] =
    "prediction_image";  ///< sensor_msgs/Image: camera image, reconstruction, prediction
constexpr char kFeatureSpaceImage[] =
    "feature_space_image";  ///< sensor_msgs/Image: features of the images and of the plan
/// std_msgs/String, latched: YAML with the text of trials.csv and the goal
constexpr char kTrials[] = "trials";

/// sensor_msgs/Image: unprocessed images of a robot's camera
constexpr char kCamera[] = "camera/source";
/// sensor_msgs/JointState of a robot, for its joint limits
constexpr char kJointStates[] = "joint_states";
constexpr char kLatency[] = "latency";  ///< std_msgs/Float64: time from an image to its torque [s]
constexpr char kDeadlineMisses[] =
    "deadline_misses";  ///< std_msgs/UInt32, latched: images in trials without a torque in time

constexpr char kReset[] = "reset";                     ///< ddm_msgs/Reset
constexpr char kStartRecording[] = "start_recording";  ///< ddm_msgs/StartRecording
constexpr char kStopRecording[] = "stop_recording";    ///< ddm_msgs/StopRecording

/// std_srvs/SetBool: switches the motors of a robot on or off
constexpr char kEnable[] = "enable";
/// std_msgs/Bool, latched: false after `enable` or a fault has switched the motors off
constexpr char kMotorsEnabled[] = "motors_enabled";
/// std_srvs/Trigger: takes the goal image; call it when the robot is at its goal
constexpr char kTakeGoal[] = "take_goal";
/// std_srvs/Trigger: the user reports that the robot is at its initial state
constexpr char kResetDone[] = "reset_done";

constexpr char kTrain[] = "train";         ///< ddm_msgs/Train.action
constexpr char kRunTrial[] = "run_trial";  ///< ddm_msgs/RunTrial.action

}  // namespace topics
}  // namespace ddm
