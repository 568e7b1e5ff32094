#include "rbd/model/frame.h"

namespace rbd {

const char* frameTypeName(FrameType type) {
  switch (type) {
    case OP_FRAME:
      return "OP_FRAME";
    case JOINT:
      return "JOINT";
    case FIXED_JOINT:
      return "FIXED_JOINT";
    case BODY:
      return "BODY";
    case SENSOR:
      return "SENSOR";
    case ANY_FRAME:
      break;
  }
  return "ANY_FRAME";
}

}  // namespace rbd
