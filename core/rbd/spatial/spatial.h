// All spatial types.
#pragma once

#include "rbd/spatial/inertia.h"
#include "rbd/spatial/motion.h"
#include "rbd/spatial/so3.h"
#include "rbd/spatial/transform.h"
