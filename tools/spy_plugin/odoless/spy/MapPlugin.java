package odoless.spy;

import bot_core.planar_lidar_t;
import bot_core.pose_t;
import java.awt.event.ActionEvent;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JInternalFrame;
import lcm.lcm.LCM;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import odoless.map_tile_t;
import odoless.motion_t;
import odoless.pose_estimate_t;

/** Makes lcm-spy offer a window with map, path and scan for any channel that has to do with them. */
public final class MapPlugin implements SpyPlugin {
  public static final String TITLE = "odoless map";

  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == map_tile_t.LCM_FINGERPRINT
        || fingerprint == motion_t.LCM_FINGERPRINT
        || fingerprint == pose_estimate_t.LCM_FINGERPRINT
        || fingerprint == pose_t.LCM_FINGERPRINT
        || fingerprint == planar_lidar_t.LCM_FINGERPRINT;
  }

  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction(TITLE) {
      @Override
      public void actionPerformed(ActionEvent event) {
        final JInternalFrame frame = new JInternalFrame(TITLE, true, true, true, true);
        frame.add(new MapPanel(new MapModel(LCM.getSingleton(), prefixOf(channel.name))));
        frame.pack();
        desktop.add(frame);
        frame.setVisible(true);
      }
    };
  }

  /** What stands before the name of one of our channels. */
  static String prefixOf(String channel) {
    for (String name : new String[] {"MAP_TILE", "POSE_COVARIANCE", "LASER_POSE", "POSE", "SCAN", "MOTION"}) {
      if (channel.endsWith(name)) {
        return channel.substring(0, channel.length() - name.length());
      }
    }
    return channel;
  }
}
