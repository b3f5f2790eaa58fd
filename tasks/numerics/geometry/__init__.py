"""The ground under all shelves: meshes, distances over surfaces, normals, nearest points, rigid motions."""
