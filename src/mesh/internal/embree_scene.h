#pragma once
/// Owners of Embree's handles.

#include <embree3/rtcore.h>

#include <utility>

namespace pellicle {

/// A device and one scene on it; both released at the end.
class EmbreeScene {
 public:
  EmbreeScene() : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCDevice device() const { return device_; }
  RTCScene scene() const { return scene_; }
  /// Takes over `geometry`, adds it and builds the tree.
  void commit(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace pellicle
