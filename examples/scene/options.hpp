#pragma once

#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

// What all example scenes share: their command line and how they end.
namespace scene {

struct Options {
  std::filesystem::path output = ".";  // where pictures go
  int cells = 0;                       // across the beam; 0: the scene's own
};

/// Parses the command line, runs the scene, and turns a thrown error into a message and an exit status.
template <class Run>
int main(int argc, char** argv, std::string const& description, Run const& run) {
  CLI::App app(description);
  Options options;
  app.add_option("--output", options.output, "folder for the pictures")->capture_default_str();
  app.add_option("--cells", options.cells, "cells across the beam (0: the scene's own)");
  CLI11_PARSE(app, argc, argv);
  try {
    std::filesystem::create_directories(options.output);
    run(options);
    return 0;
  } catch (std::exception const& error) {
    std::cerr << "error: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace scene
