package odoless.spy;

import java.io.DataInput;
import java.io.IOException;
import java.util.Arrays;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import lcm.spy.LCMTypeDatabase;

/**
 * Listens as lcm-spy does and tells what it decoded: SECONDS [CHANNEL...]. Fails if there is a message that does not
 * decode, none at all, or none on one of the channels that are named.
 */
public final class Check implements LCMSubscriber {
  private static final class Channel {
    String type = "?";
    int messages;
    int undecodable;
  }

  private final LCMTypeDatabase types = new LCMTypeDatabase();
  private final Map<String, Channel> channels = new TreeMap<>();

  private Check() {}

  public static void main(String[] arguments) throws InterruptedException {
    final Check check = new Check();
    LCM.getSingleton().subscribeAll(check);
    Thread.sleep((long) (1000.0 * Double.parseDouble(arguments[0])));
    System.exit(check.report(Arrays.asList(arguments).subList(1, arguments.length)) ? 0 : 1);
  }

  @Override
  public synchronized void messageReceived(LCM lcm, String name, LCMDataInputStream in) {
    final Channel channel = channels.computeIfAbsent(name, unused -> new Channel());
    ++channel.messages;
    try {
      channel.type = decode(in);
    } catch (IOException | ReflectiveOperationException | RuntimeException wrong) {
      ++channel.undecodable;
    }
  }

  /** Finds the type by the fingerprint, decodes, and wants every byte to be used. */
  private String decode(LCMDataInputStream in) throws IOException, ReflectiveOperationException {
    final long fingerprint = in.readLong();
    in.reset();
    final Class<?> type = types.getClassByFingerprint(fingerprint);
    if (type == null) {
      throw new IOException("unknown type");
    }
    type.getConstructor(DataInput.class).newInstance(in);
    if (in.available() != 0) {
      throw new IOException("bytes are left over");
    }
    return type.getName();
  }

  private synchronized boolean report(List<String> wanted) {
    boolean right = !channels.isEmpty();
    System.out.printf("%-28s %-28s %8s %12s%n", "channel", "type", "messages", "undecodable");
    for (Map.Entry<String, Channel> entry : channels.entrySet()) {
      final Channel channel = entry.getValue();
      System.out.printf("%-28s %-28s %8d %12d%n", entry.getKey(), channel.type, channel.messages, channel.undecodable);
      right &= channel.undecodable == 0;
    }
    for (String name : wanted) {
      if (!channels.containsKey(name)) {
        System.out.println("nothing on " + name);
        right = false;
      }
    }
    return right;
  }
}
