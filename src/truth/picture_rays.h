#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "truth/pinhole.h"
#include "truth/seen_surfaces.h"

namespace cradle {

/// What a pixel's ray meets first.
struct SeenPoint {
  double depth = std::numeric_limits<double>::infinity();  // m, along the view; infinite: the sky
  std::int32_t surface = -1;                               // index into the surfaces; -1: the sky
  std::int32_t triangle = -1;                              // of a surface of triangles

  bool isSky() const { return surface < 0; }
};

using PictureBox = Eigen::AlignedBox2d;  // pixel coordinates

/// The pixels whose centres a body covers, whether or not others hide it.
struct WholeExtent {
  long pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // half-open
};

/// Rays of a picture against surfaces, in double precision. Of a surface of triangles no ray slips through between two
/// of them: J. D. Olano, T. Greer, "Triangle scan conversion using 2D homogeneous coordinates", Graphics Hardware 1997.
class PictureRays {
 public:
  /// Both must outlive this object. O(vertices).
  PictureRays(const std::vector<SeenSurface>& surfaces, const Pinhole& pinhole);

  /// Of each pixel, row by row from above. `wholes` gets those of each body, by its index.
  /// O(vertices + triangles + pixels that surfaces cover).
  std::vector<SeenPoint> seenPoints(std::vector<WholeExtent>& wholes) const;

  /// What the ray at pixel coordinates (x, y) inside of the picture first meets. O(triangles) once, then O(what is near
  /// in the picture).
  SeenPoint seenAt(double x, double y);

  /// Of a point that is seen at (x, y): m, world; unit, world, towards the camera.
  Vec3 pointAt(double x, double y, const SeenPoint& seen) const;
  Vec3 normalAt(double x, double y, const SeenPoint& seen) const;

 private:
  struct Prepared {
    PictureBox box;              // pixel coordinates, outside of which it is not seen
    Vec3 origin;                 // of the camera, in the shape's frame
    Mat3 shapeFromCamera;        // turns directions
    std::vector<Vec3> vertices;  // of triangles: camera's coordinates
  };
  struct Facet {
    Eigen::AlignedBox2f box;  // pixel coordinates, outside of which it is not seen
    std::int32_t surface, triangle;
  };
  PictureBox boxAround(const Vec3* corners, std::size_t count) const;
  template <class Visit>
  void visitCentres(const PictureBox& box, const Visit& visit) const;
  template <class Visit>
  void visitFacets(std::size_t surface, const Visit& visit) const;
  void fillTiles();

  const std::vector<SeenSurface>& surfaces_;
  const Pinhole& pinhole_;
  std::vector<Prepared> prepared_;
  std::vector<std::vector<Facet>> tiles_;  // of the picture, row by row: what may be seen there; empty until asked for
  int tilesAcross_, tilesDown_;
};

}  // namespace cradle
