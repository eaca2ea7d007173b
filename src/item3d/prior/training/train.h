// Training the embedded prior from nothing: data, tokenizer, autoencoder, text encoder and U-Net.
#pragma once

#include "item3d/prior/data/captions.h"
#include "item3d/prior/training/settings.h"

#include <vector>

namespace item3d {

/// The words that all tokenizers are made of.
std::vector<WordCount> prior_words(const TrainSettings& settings);

/// The whole training; fills settings.output and measures it. Process 0 makes the data and writes
/// everything; the others get all that they need from it.
void train_prior(const TrainSettings& settings);

}  // namespace item3d
