// The subcommands of `item3d prior` that have their own source files.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

/// Adds `prior pull`: downloads a prior from the Hugging Face hub into its cache.
void add_prior_pull(CLI::App& prior);
/// Adds `prior verify`: lists a folder's parts and checks that an edit can use it.
void add_prior_verify(CLI::App& prior);

/// Adds `prior evaluate`: computes scores and samples of a prior.
void add_prior_evaluate(CLI::App& prior);
/// Adds `prior list`: lists the names that --prior takes.
void add_prior_list(CLI::App& prior);

}  // namespace item3d
