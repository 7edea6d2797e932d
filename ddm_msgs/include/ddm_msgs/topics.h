// Names of the wire contract, relative: remap them or push them into a namespace.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {
namespace topics {

constexpr char kImage[] = "camera/image_raw";  ///< sensor_msgs/Image
constexpr char kImageInfo[] =
    "camera/camera_info";  ///< sensor_msgs/CameraInfo, latched: where the camera has a lens
constexpr char kView[] =
    "camera_view/image_raw";  ///< sensor_msgs/Image for people: large, drawn while subscribed
constexpr char kViewInfo[] = "camera_view/camera_info";  ///< sensor_msgs/CameraInfo, latched
constexpr char kGoalImage[] = "goal_image";              ///< sensor_msgs/Image, latched
constexpr char kTorque[] = "torque";                     ///< ddm_msgs/Torque
constexpr char kAppliedTorque[] =
    "applied_torque";  ///< ddm_msgs/Torque: what acted as the answer to each image, if anything
constexpr char kEffortCommand[] = "effort_command";  ///< std_msgs/Float64 [N m]: one motor
constexpr char kGroupEffortCommand[] =
    "group_effort_command";  ///< std_msgs/Float64MultiArray [N m]: several motors
constexpr char kGroundTruth[] =
    "ground_truth/joint_states";                 ///< sensor_msgs/JointState, evaluation only
constexpr char kModel[] = "model";               ///< ddm_msgs/Model, latched
constexpr char kPlan[] = "plan";                 ///< ddm_msgs/Plan
constexpr char kPlanScalars[] = "plan_scalars";  ///< ddm_msgs/PlanScalars
constexpr char kPredictionImage[] =
    "prediction_image";  ///< sensor_msgs/Image: camera, reconstruction, prediction
constexpr char kFeatureSpaceImage[] =
    "feature_space_image";            ///< sensor_msgs/Image: what the model thinks
constexpr char kTrials[] = "trials";  ///< std_msgs/String, latched: trials.csv and its goal

constexpr char kCamera[] = "camera/source";  ///< sensor_msgs/Image: a robot's camera, as it comes
constexpr char kJointStates[] = "joint_states";  ///< sensor_msgs/JointState: a robot's, for limits
constexpr char kLatency[] = "latency";  ///< std_msgs/Float64: from an image to its torque [s]
constexpr char kDeadlineMisses[] =
    "deadline_misses";  ///< std_msgs/UInt32, latched: images of trials without a timely torque

constexpr char kReset[] = "reset";                     ///< ddm_msgs/Reset
constexpr char kStartRecording[] = "start_recording";  ///< ddm_msgs/StartRecording
constexpr char kStopRecording[] = "stop_recording";    ///< ddm_msgs/StopRecording

constexpr char kEnable[] = "enable";  ///< std_srvs/SetBool: motors of a robot
constexpr char kMotorsEnabled[] =
    "motors_enabled";  ///< std_msgs/Bool, latched: what `enable` set, or a fault took back
constexpr char kTakeGoal[] = "take_goal";    ///< std_srvs/Trigger: the robot is at its goal
constexpr char kResetDone[] = "reset_done";  ///< std_srvs/Trigger: the robot is at its start

constexpr char kTrain[] = "train";         ///< ddm_msgs/Train.action
constexpr char kRunTrial[] = "run_trial";  ///< ddm_msgs/RunTrial.action

}  // namespace topics
}  // namespace ddm
