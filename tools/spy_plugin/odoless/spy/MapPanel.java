package odoless.spy;

import bot_core.planar_lidar_t;
import bot_core.pose_t;
import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.geom.AffineTransform;
import java.awt.geom.Path2D;
import java.awt.geom.Rectangle2D;
import javax.swing.JPanel;
import javax.swing.Timer;

/** Draws a MapModel ten times a second, scaled so that all of it is seen; y points up. */
final class MapPanel extends JPanel {
  private static final int PERIOD_MS = 100;
  private static final double MARGIN_M = 1.0;
  private static final Color UNKNOWN = new Color(0xb0b8c0);
  private static final Color SCAN = new Color(0xd02020);
  private static final Color PATH = new Color(0x2060c0);
  private static final Color ROBOT = new Color(0x10a040);

  private final MapModel model;
  private final Timer timer = new Timer(PERIOD_MS, tick -> repaint());

  MapPanel(MapModel model) {
    this.model = model;
    setPreferredSize(new Dimension(700, 700));
    setBackground(UNKNOWN);
    timer.start();
  }

  @Override
  protected void paintComponent(Graphics graphics) {
    super.paintComponent(graphics);
    final Graphics2D canvas = (Graphics2D) graphics.create();
    canvas.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    canvas.drawString(model.status(), 8, 16);
    final double pixelM = toMap(canvas);
    canvas.setStroke(new BasicStroke((float) (1.5 * pixelM)));
    drawTiles(canvas);
    canvas.setColor(PATH);
    canvas.draw(model.path());
    final pose_t laserPose = model.laserPose();
    if (laserPose != null) {
      final AffineTransform map = canvas.getTransform();
      canvas.transform(placeOf(laserPose));
      drawScan(canvas, model.scan(), pixelM);
      canvas.setTransform(map);
    }
    final pose_t pose = model.pose();
    if (pose != null) {
      canvas.transform(placeOf(pose));
      drawRobot(canvas, pixelM);
    }
    canvas.dispose();
  }

  /** What takes coordinates of the plane at a pose to the map; mirrored where it hangs upside down. */
  private static AffineTransform placeOf(pose_t pose) {
    final double w = pose.orientation[0];
    final double x = pose.orientation[1];
    final double y = pose.orientation[2];
    final double z = pose.orientation[3];
    return new AffineTransform(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * y - w * z),
        1.0 - 2.0 * (x * x + z * z), pose.pos[0], pose.pos[1]);
  }

  /** From here on coordinates are metres in the map. Returns how many of them a pixel is. */
  private double toMap(Graphics2D canvas) {
    final Rectangle2D seen = extent();
    final double pixelM = Math.max(seen.getWidth() / getWidth(), seen.getHeight() / getHeight());
    canvas.translate(getWidth() / 2.0, getHeight() / 2.0);
    canvas.scale(1.0 / pixelM, -1.0 / pixelM);
    canvas.translate(-seen.getCenterX(), -seen.getCenterY());
    return pixelM;
  }

  private Rectangle2D extent() {
    final pose_t pose = model.pose();
    final double x = pose == null ? 0.0 : pose.pos[0];
    final double y = pose == null ? 0.0 : pose.pos[1];
    final Rectangle2D seen = new Rectangle2D.Double(x - MARGIN_M, y - MARGIN_M, 2.0 * MARGIN_M, 2.0 * MARGIN_M);
    for (MapModel.Tile tile : model.tiles()) {
      seen.add(new Rectangle2D.Double(tile.leftM(), tile.bottomM(), tile.sideM(), tile.sideM()));
    }
    return seen;
  }

  private void drawTiles(Graphics2D canvas) {
    for (MapModel.Tile tile : model.tiles()) {
      final double cellM = tile.sideM() / tile.picture().getWidth();
      final AffineTransform place = AffineTransform.getTranslateInstance(tile.leftM(), tile.bottomM() + tile.sideM());
      place.scale(cellM, -cellM);
      canvas.drawImage(tile.picture(), place, null);
    }
  }

  private static void drawScan(Graphics2D canvas, planar_lidar_t scan, double pixelM) {
    if (scan == null) {
      return;
    }
    canvas.setColor(SCAN);
    final double dotM = 2.0 * pixelM;
    for (int beam = 0; beam < scan.nranges; ++beam) {
      final double rangeM = scan.ranges[beam];
      if (rangeM > 0.0 && !Double.isInfinite(rangeM)) {
        final double angle = scan.rad0 + beam * (double) scan.radstep;
        final double x = rangeM * Math.cos(angle);
        final double y = rangeM * Math.sin(angle);
        canvas.fill(new Rectangle2D.Double(x - dotM / 2.0, y - dotM / 2.0, dotM, dotM));
      }
    }
  }

  private static void drawRobot(Graphics2D canvas, double pixelM) {
    final double sizeM = 9.0 * pixelM;
    final Path2D arrow = new Path2D.Double();
    arrow.moveTo(1.5 * sizeM, 0.0);
    arrow.lineTo(-sizeM, sizeM);
    arrow.lineTo(-sizeM, -sizeM);
    arrow.closePath();
    canvas.setColor(ROBOT);
    canvas.fill(arrow);
  }
}
