#version 330 core

// Only depth is wanted.
void main() {}
