// The neural textures before and after an edit, as the edit's layer stores them: in half precision.
// The layer stores the rows of the neural texture's table that the edit changed.
#pragma once

#include "item3d/field/neural_texture.h"
#include "item3d/layers/layer.h"

namespace item3d {

/// The fields (neural textures) before and after an edit, with equal options.
struct EditFields {
    NeuralTexture fitted{nullptr};  ///< before the edit
    NeuralTexture field{nullptr};   ///< after the edit
};

/// Sets layer.field and layer.parameters: "fitted.NAME" and "field.NAME" for each NAME of
/// NeuralTextureImpl::named_parameters(), float16. The table of `field` is stored as the R rows
/// that the edit changed: "field.rows" [R] int32 has their indices, "field.values" [R, features]
/// their values.
void put_fields(const EditFields& fields, EditLayer& layer);

/// Returns the fields, in half precision, on the CPU. Parameters that the edit did not change are
/// equal in both fields. Throws InputError where the layer's tensors do not match its options.
EditFields get_fields(const EditLayer& layer);

}  // namespace item3d
