package odoless.spy;

import bot_core.planar_lidar_t;
import bot_core.pose_t;
import java.awt.geom.Path2D;
import java.awt.geom.Point2D;
import java.awt.image.BufferedImage;
import java.io.IOException;
import java.util.HashMap;
import java.util.Map;
import java.util.zip.DataFormatException;
import java.util.zip.Inflater;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import odoless.map_tile_t;

/** What the messages of one robot have told: map, pose, path and scan. Guarded by its own lock. */
final class MapModel implements LCMSubscriber {
  private static final int UNKNOWN = 255;
  private static final int SIDE_MAX_CELLS = 1024;
  private static final double PATH_STEP_M = 0.02;

  /** A square of the map as a picture, its first line at the top, that is at the highest y. */
  record Tile(BufferedImage picture, double leftM, double bottomM, double sideM) {}

  private final String prefix;
  private final Map<Long, Tile> tiles = new HashMap<>();
  private final Path2D.Double path = new Path2D.Double();
  private pose_t pose;
  private pose_t laserPose;
  private planar_lidar_t scan;
  private int errors;

  /** Listens to the channels that begin with {@code prefix}. */
  MapModel(LCM lcm, String prefix) {
    this.prefix = prefix;
    for (String name : new String[] {"MAP_TILE", "POSE", "LASER_POSE", "SCAN"}) {
      lcm.subscribe(prefix + name, this);
    }
  }

  @Override
  public synchronized void messageReceived(LCM lcm, String channel, LCMDataInputStream in) {
    try {
      if (channel.equals(prefix + "MAP_TILE")) {
        add(new map_tile_t(in));
      } else if (channel.equals(prefix + "POSE")) {
        add(new pose_t(in));
      } else if (channel.equals(prefix + "LASER_POSE")) {
        laserPose = new pose_t(in);
      } else if (channel.equals(prefix + "SCAN")) {
        scan = new planar_lidar_t(in);
      }
    } catch (IOException | DataFormatException | RuntimeException wrong) {
      ++errors;
    }
  }

  private void add(pose_t now) {
    final Point2D end = path.getCurrentPoint();
    if (end == null) {
      path.moveTo(now.pos[0], now.pos[1]);
    } else if (end.distance(now.pos[0], now.pos[1]) > PATH_STEP_M) {
      path.lineTo(now.pos[0], now.pos[1]);
    }
    pose = now;
  }

  private void add(map_tile_t tile) throws DataFormatException {
    final int side = tile.size_cells;
    if (side < 1 || side > SIDE_MAX_CELLS) {
      throw new DataFormatException("a tile of " + side + " cells");
    }
    final byte[] cells = new byte[side * side];
    final Inflater inflater = new Inflater();
    inflater.setInput(tile.data);
    final int inflated = inflater.inflate(cells);
    inflater.end();
    if (inflated != cells.length) {
      throw new DataFormatException("a tile that is cut short");
    }
    final double sideM = side * tile.cell_size_m;
    final long key = ((long) tile.column << 32) ^ (tile.row & 0xffffffffL);
    tiles.put(key, new Tile(picture(cells, side), tile.column * sideM, tile.row * sideM, sideM));
  }

  private static BufferedImage picture(byte[] cells, int side) {
    final BufferedImage picture = new BufferedImage(side, side, BufferedImage.TYPE_INT_ARGB);
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        final int percent = cells[row * side + column] & 0xff;
        if (percent != UNKNOWN) {
          final int grey = 255 - 255 * Math.min(percent, 100) / 100;
          picture.setRGB(column, side - 1 - row, 0xff000000 | grey << 16 | grey << 8 | grey);
        }
      }
    }
    return picture;
  }

  synchronized Tile[] tiles() {
    return tiles.values().toArray(new Tile[0]);
  }

  synchronized Path2D path() {
    return new Path2D.Double(path);
  }

  synchronized pose_t pose() {
    return pose;
  }

  synchronized pose_t laserPose() {
    return laserPose;
  }

  synchronized planar_lidar_t scan() {
    return scan;
  }

  synchronized String status() {
    return tiles.size() + " tiles" + (errors == 0 ? "" : ", " + errors + " messages that do not decode");
  }
}
