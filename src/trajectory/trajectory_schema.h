#pragma once

namespace cradle {

/// Marks a SQLite file as a trajectory ("CRDL" in ASCII), and the version of its tables.
constexpr int kApplicationId = 0x4352444c;
constexpr int kSchemaVersion = 1;

/// The tables, as docs/trajectory_file.md describes them. Columns of numbers have no declared type on purpose: SQLite
/// would store -0.0 as 0 in a column declared REAL, and states are to come back bit by bit. `state` is clustered by
/// frame, the way pictures ask for it.
constexpr const char* kTables = R"sql(
CREATE TABLE meta (key TEXT PRIMARY KEY, value) WITHOUT ROWID;
CREATE TABLE mesh (id INTEGER PRIMARY KEY, name TEXT,
  vertices BLOB,   -- m, body's frame; 3 float64 each, little-endian
  normals BLOB,    -- unit, one per vertex; 3 float32
  triangles BLOB,  -- vertex numbers, counter-clockwise from outside; 3 uint32
  material TEXT,   -- JSON: name, baseColor, firstTriangle, triangleCount, and texture if it has one, of each range of
                   -- triangles
  vertexNumbers BLOB);  -- of each vertex, as scenes have them: those at one place share it; uint32
CREATE TABLE body (id INTEGER PRIMARY KEY, name TEXT UNIQUE,
  motion TEXT,              -- dynamic, static or driven
  mesh INTEGER,             -- id, or null if it has a shape
  shape TEXT,               -- JSON of a primitive as in the scene file, or null
  mass,                     -- kg; 0 unless dynamic
  comx, comy, comz,         -- m, centre of mass in the body's frame
  ixx, iyy, izz, ixy, ixz, iyz);  -- kg m^2, about the centre of mass, body's frame
CREATE TABLE frame (id INTEGER PRIMARY KEY, time);  -- s
CREATE TABLE state (frame INTEGER, body INTEGER,
  px, py, pz,      -- m, centre of mass, world
  qw, qx, qy, qz,  -- orientation, world from body
  vx, vy, vz,      -- m/s, of the centre of mass
  wx, wy, wz,      -- rad/s, world
  PRIMARY KEY (frame, body)) WITHOUT ROWID;
CREATE TABLE joint (id INTEGER PRIMARY KEY, name TEXT UNIQUE,
  kind TEXT,               -- hinge or slider
  a INTEGER, b INTEGER);   -- bodies; b null for the world
CREATE TABLE joint_state (frame INTEGER, joint INTEGER,
  coordinate,  -- rad or m, of A against B, 0 at the start, whole turns counted
  velocity,    -- rad/s or m/s
  force,       -- N m or N, of the joint's motor on A
  PRIMARY KEY (frame, joint)) WITHOUT ROWID;
CREATE TABLE event (time, kind TEXT,
  a INTEGER, b INTEGER,  -- bodies; b null for the world
  x, y, z,               -- m, world
  nx, ny, nz,            -- unit, from a to b
  impulse);              -- N s
CREATE TABLE contact (id INTEGER PRIMARY KEY,  -- bodies that press each other for a while
  a INTEGER, b INTEGER,  -- bodies
  begin, end);           -- s; end null until it is known
CREATE TABLE contact_force (frame INTEGER, contact INTEGER,  -- a row where it differs from the contact's last one
  fx, fy, fz,        -- N, world, of a on b
  tx, ty, tz,        -- N m, world, of a on b about the point
  x, y, z,           -- m, world: the centre of pressure
  nx, ny, nz,        -- unit, from a to b: of the normal part
  normal, friction,  -- N, of the force: along that, and the rest
  PRIMARY KEY (frame, contact)) WITHOUT ROWID;
CREATE TABLE camera (frame INTEGER PRIMARY KEY,  -- of pictures of the scene's size, once it is known
  px, py, pz,      -- m, world
  qw, qx, qy, qz,  -- world from camera: x right, y up, z against the view
  verticalFieldOfView);  -- rad
CREATE TABLE checkpoint (frame INTEGER PRIMARY KEY,  -- of an unfinished run, the latest
  record BLOB,       -- what the run goes on from
  fingerprint TEXT,  -- of the build of the program that can, and of all that the motion depends on
  stateHash TEXT);   -- of the frames by then
CREATE TABLE energy (frame INTEGER PRIMARY KEY, kinetic, potential, dissipated, work,  -- J
  px, py, pz,   -- kg m/s
  lx, ly, lz,   -- kg m^2/s, about the world origin
  impact, friction, damping,  -- J, parts of dissipated
  numerical);                 -- J, lost by errors of the method
)sql";

/// Those of trajectories with textures.
constexpr const char* kTextureTables = R"sql(
CREATE TABLE texture (id INTEGER PRIMARY KEY, name TEXT,
  image BLOB);        -- a PNG or JPEG file; first those of the scene's materials
CREATE TABLE texture_coordinates (mesh INTEGER PRIMARY KEY,
  coordinates BLOB);  -- one pair per vertex, from the left and from below, 1 across; 2 float32
)sql";

}  // namespace cradle
