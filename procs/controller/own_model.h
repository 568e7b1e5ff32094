// The model that the controller uses: the nominal one with the errors of `controller.model`. Joints,
// frames, limits and rotors are nominal; only bodies are wrong.
#pragma once
#include <rbd/model/model.h>

#include "lab/experiment/experiment.h"

namespace lab::controller {

/// First `without` takes bodies away, then `com_shift` moves centres of mass, then `mass_scale` scales all of them.
/// A body is named by its link, or by a joint: then all that moves with it in one piece. Throws ExperimentError for
/// a name that is no body.
rbd::Model own_model(const Experiment&, const rbd::Model& nominal);

}  // namespace lab::controller
